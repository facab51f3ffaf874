#include "case.h"
#include "shared/phase.h"

#define CASE_PHASE_IN 4
#define CASE_PHASE_OUT 10
CASE(case_phase) {
    float c = IN_FLOAT(0);
    float g = IN_FLOAT(1);
    float alpha = IN_FLOAT(2);
    velum_phase_droplet droplet = velum_phase_droplet_of(IN_FLOAT(3));
    OUT_FLOAT(0, velum_phase_hg(c, g));
    OUT_FLOAT(1, velum_phase_draine(c, g, alpha));
    OUT_FLOAT(2, velum_phase_draine_mean_cosine(g, alpha));
    OUT_FLOAT(3, droplet.g_hg);
    OUT_FLOAT(4, droplet.g_draine);
    OUT_FLOAT(5, droplet.alpha);
    OUT_FLOAT(6, droplet.weight_draine);
    OUT_FLOAT(7, velum_phase_droplet_at(droplet, c));
    OUT_FLOAT(8, velum_phase_cloud(c, false));
    OUT_FLOAT(9, velum_phase_cloud(c, true));
}
