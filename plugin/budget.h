/* budget_ms and budget_error of an eye: from the host's wish to the governor, and from timestamps back to it. */
#ifndef PLUGIN_BUDGET_H
#define PLUGIN_BUDGET_H

#include "engine.h"

bool budget_check(checker *check, const velum_eye_desc *desc);
/* After the eye's quality; may change it. */
void budget_init(eye *y, const velum_eye_desc *desc);
/* Rays and steps of the eye's next frame; without budget_ms, those of its quality. */
governor_setting budget_next(const engine *e, eye *y);
/* Of the plan that budget_next went into. */
void budget_reasons(const engine *e, eye *y);
/* What the finished frame took, to the governors of its eyes. */
void budget_learn(engine *e, const frame_slot *slot);

#endif
