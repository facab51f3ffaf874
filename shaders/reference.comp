#version 460
#extension GL_GOOGLE_include_directive : require
/* The reference: paths of light from the eye through every order of scattering. Unbiased: collisions by delta tracking
 * (Woodcock et al. 1965) against bounds of stretches, light of the sun at each by ratio tracking (Novak et al. 2014),
 * three channels at once with probabilities that know the path's history (Kutz et al. 2017), so that their weights stay
 * within three times their mean. An invocation makes paths as long as there are any; each path's numbers depend on its
 * pixel and its own number alone. */
#include "reference_cell.glsl"
#include "shared/hash.h"
layout(local_size_x_id = 1, local_size_y = 1) in;
layout(set = 1, binding = VELUM_BIND_REFERENCE_PATHS, std430) writeonly buffer paths_buffer {
    velum_reference_path paths[];
};
layout(set = 1, binding = VELUM_BIND_REFERENCE_ERROR, std430) buffer slice_buffer {
    uint slice[VELUM_SLICE_WORDS];
};
layout(set = 1, binding = VELUM_BIND_REFERENCE_LANES, std430) buffer lanes_buffer {
    velum_reference_lane lanes[];
};
layout(set = 1, binding = VELUM_BIND_COUNTERS, std430) buffer counter_buffer {
    uint counters[VELUM_COUNTER_WORDS];
};

/* What an invocation is at. */
const int at_start = 0;  /* of a path */
const int at_view = 1;   /* along the pixel's ray, through all of it: its transmittance, and where it scatters first */
const int at_flight = 2; /* to the next collision */
const int at_sun = 3;    /* from a collision towards the sun */
const int at_end = 4;    /* no path is left */

uint key;
uint drawn;
float draw() {
    return velum_hash_unit(velum_hash_2(key, drawn++));
}

float mean(vec3 x) {
    return (x.r + x.g + x.b) * (1.0 / 3.0);
}

/* Unit vector turned from d by an angle of 1 - cos = turn, about by `round` 0..1. Frame: Duff et al. 2017. */
vec3 turned(vec3 d, float turn, float round) {
    float s = d.z >= 0.0 ? 1.0 : -1.0;
    float a = -1.0 / (s + d.z);
    float b = d.x * d.y * a;
    vec3 x = vec3(1.0 + s * d.x * d.x * a, s * b, -s * d.x);
    vec3 y = vec3(b, s + d.y * d.y * a, -d.y);
    float sine = sqrt(max(turn * (2.0 - turn), 0.0));
    float angle = 2.0 * PI * round;
    return normalize(d * (1.0 - turn) + (x * cos(angle) + y * sin(angle)) * sine);
}

/* 1 - cos between unit vectors, with all digits. */
float turn_between(vec3 a, vec3 b) {
    vec3 c = a - b;
    return min(0.5 * dot(c, c), 2.0);
}

/* Where a ray from r ends: on the ground, or where nothing is any more. */
float ray_length(vec3 r, vec3 d, bool from_ground, out bool grounded) {
    velum_place place = place_of(r);
    float rise = dot(vec3(place.nx, place.ny, place.nz), d);
    float top = max(eye.table.z != 0u ? eye.span.y : 0.0, eye.ground.w != 0.0 ? VELUM_AIR_TOP_M : 0.0);
    float ground = -1.0;
    for (int once = from_ground || (rise >= 0.0 && place.height_m > 0.0) ? 1 : 0; once < 1; ++once) {
        ground = ground_distance(r, d);
    }
    grounded = ground >= 0.0;
    velum_span shell = velum_sphere_span(eye_geometry(), r.x, r.y, r.z, d.x, d.y, d.z, top * VELUM_SCALE_Z + 5.0);
    float leave = shell.enter_m > shell.leave_m ? 0.0 : max(shell.leave_m, 0.0);
    return grounded ? ground : leave;
}

bool is_bad(vec4 v) {
    return any(isnan(v)) || any(isinf(v));
}

void main() {
    const int greatest_order = int(view.steps.x);
    const float branching = view.march.x; /* sunward branches for each collision */
    const float branch_g = view.march.y;
    const bool draws_ground = view_flag(VELUM_VIEW_BLOCK_GROUND);
    const uint count = view.march_size.y * view.march_size.z;
    const uint pixel_count = view.size.x * view.size.y;

    int state = at_start;
    uint path_index = 0u;
    vec3 r = vec3(0.0);
    vec3 d = vec3(0.0, 0.0, 1.0);
    float left_m = 0.0;
    bool grounded = false; /* the ray ends on the ground */
    stretch s = stretch(0.0, 0.0, 0u, 0.0, tile_nowhere());

    vec3 weight = vec3(0.0);
    vec3 light = vec3(0.0);
    int order = 0;
    /* Along the pixel's ray. */
    vec3 origin = vec3(0.0);
    float ray_m = 0.0;
    vec3 through = vec3(1.0);
    float through_cloud = 1.0;
    float chosen_sum = 0.0;
    vec3 chosen_weight = vec3(0.0);
    float chosen_m = 0.0;
    int chosen_medium = 0;
    float cloud_m = 0.0;
    float cloud_weight = 0.0;
    bool host_solid = false;
    /* The newest collision. */
    int medium = 0;
    vec3 incoming = vec3(0.0);
    vec3 sun_light = vec3(0.0);
    /* Waits while a sunward branch is followed. */
    bool waiting = false;
    vec3 waiting_r = vec3(0.0);
    vec3 waiting_d = vec3(0.0);
    vec3 waiting_weight = vec3(0.0);
    int waiting_order = 0;
    bool waiting_from_ground = false;

    uint samples = 0u;
    uint light_samples = 0u;
    uint above = 0u;
    uint begun = 0u;
    uint finished = 0u;
    bool missing = false;

    /* Software devices give up loops after some 65,000 rounds, all loops of an invocation together: a lane stops before
     * that, and goes on where it was in the next dispatch. */
    const uint own = gl_GlobalInvocationID.x;
    const uint most_rounds = view.steps.w;
    if (view.steps.z != 0u) {
        velum_reference_lane lane = lanes[own];
        state = int(lane.state.x);
        path_index = lane.state.y;
        key = lane.state.z;
        drawn = lane.state.w;
        order = int(lane.flags.x);
        waiting_order = int(lane.flags.y);
        medium = int(lane.flags.z & 255u);
        chosen_medium = int(lane.flags.z >> 8u);
        grounded = (lane.flags.w & 1u) != 0u;
        host_solid = (lane.flags.w & 2u) != 0u;
        waiting = (lane.flags.w & 4u) != 0u;
        waiting_from_ground = (lane.flags.w & 8u) != 0u;
        s.slots = lane.tile.x;
        s.tile.entry = lane.tile.y;
        s.tile_m = uintBitsToFloat(lane.tile.z);
        r = lane.r.xyz;
        left_m = lane.r.w;
        d = lane.d.xyz;
        ray_m = lane.d.w;
        s.left_m = lane.stretch.x;
        s.most_1_m = lane.stretch.y;
        chosen_m = lane.stretch.z;
        cloud_weight = lane.stretch.w;
        weight = lane.weight.xyz;
        through_cloud = lane.weight.w;
        light = lane.light.xyz;
        chosen_sum = lane.light.w;
        through = lane.through.xyz;
        cloud_m = lane.through.w;
        origin = lane.origin.xyz;
        chosen_weight = lane.chosen.xyz;
        incoming = lane.incoming.xyz;
        sun_light = lane.sun.xyz;
        waiting_r = lane.waiting_r.xyz;
        waiting_d = lane.waiting_d.xyz;
        waiting_weight = lane.waiting_weight.xyz;
    }

    for (uint round = 0u; state != at_end && round < most_rounds; ++round) {
        for (int once = state == at_start ? 0 : 1; once < 1; ++once) {
            path_index = atomicAdd(slice[VELUM_SLICE_BEGUN], 1u);
            if (path_index >= count) {
                state = at_end;
                left_m = 0.0;
                s.left_m = 0.0;
                s.most_1_m = 0.0;
                break;
            }
            ++begun;
            uint number = velum_reference_pixel_of(view.march_size.x + path_index / view.march_size.z, view.steps.y);
            if (number >= pixel_count) {
                ++finished;
                break;
            }
            ivec2 pixel = ivec2(int(number % view.size.x), int(number / view.size.x));
            key = velum_hash_4(number, view.march_size.w + path_index % view.march_size.z, view.frame.w, 0x7261790au);
            drawn = 0u;
            view_ray ray = view_ray_at(vec2(pixel) + 0.5 + view.scale.yz);
            r = origin = ray.origin;
            d = ray.direction;
            left_m = ray_length(r, d, false, grounded);
            float host_m = host_distance(pixel, ray);
            host_solid = host_m >= 0.0;
            grounded = grounded && !host_solid;
            left_m = host_solid ? min(host_m, left_m) : left_m;
            ray_m = 0.0;
            s.left_m = s.tile_m = 0.0;
            light = vec3(0.0);
            order = 0;
            through = vec3(1.0);
            through_cloud = 1.0;
            chosen_sum = 0.0;
            cloud_m = 0.0;
            cloud_weight = 0.0;
            waiting = false;
            state = at_view;
        }

        for (int once = s.left_m <= 0.0 && left_m > 0.0 ? 0 : 1; once < 1; ++once) {
            s = stretch_from(r, d, left_m, s, missing);
        }

        float step_m = s.most_1_m > 0.0 ? -log(1.0 - draw()) / s.most_1_m : far_m;
        bool inside = step_m < s.left_m;
        step_m = inside ? step_m : s.left_m;
        r += d * step_m;
        ray_m += step_m;
        left_m = inside ? left_m - step_m : (s.left_m >= left_m ? 0.0 : left_m - s.left_m);
        s.left_m = inside ? s.left_m - step_m : 0.0;
        s.tile_m = max(s.tile_m - step_m, 0.0);

        bool collides = false; /* at r, with `medium`; weight is that of what scatters */
        bool ends = false;     /* a flight has led nowhere */
        bool scatters = false; /* the sun has been seen to */

        for (int once = inside ? 0 : 1; once < 1; ++once) {
            matter m = matter_at(r, s, draw());
            samples += state == at_sun ? 0u : 1u;
            light_samples += state == at_sun ? 1u : 0u;
            vec3 extinction = m.rayleigh + m.air_loss + vec3(m.aerosol + m.haze + m.fog + m.cloud + m.cloud_loss);
            float most = s.most_1_m;
            vec3 kept = 1.0 - extinction / most;
            above += any(lessThan(kept, vec3(-1e-3))) ? 1u : 0u;

            for (int sun = state == at_sun ? 0 : 1; sun < 1; ++sun) {
                sun_light *= kept;
                float size = max(abs(sun_light.r), max(abs(sun_light.g), abs(sun_light.b)));
                float whole = max(max(eye.sun_lx.r, eye.sun_lx.g), eye.sun_lx.b);
                /* Roulette: what is dim is dropped most of the time, and else counts for more. */
                if (size < 0.02 * view.march.w * whole) {
                    bool stays = draw() < 0.25;
                    sun_light *= stays ? 4.0 : 0.0;
                    left_m = stays ? left_m : 0.0;
                }
                if (size == 0.0) {
                    left_m = 0.0;
                }
                s.left_m = left_m > 0.0 ? s.left_m : 0.0;
            }
            for (int own = state == at_sun ? 1 : 0; own < 1; ++own) {
                vec3 base = state == at_view ? through : weight;
                float of_cloud = mean(base) * m.cloud;
                float of_rayleigh = mean(base * m.rayleigh);
                float of_aerosol = mean(base) * m.aerosol;
                float of_haze = mean(base) * m.haze;
                float of_fog = mean(base) * m.fog;
                float of_loss = mean(abs(base) * (m.air_loss + m.cloud_loss));
                float of_none = mean(abs(base * kept)) * most;
                float of_all = abs(of_cloud) + abs(of_rayleigh) + abs(of_aerosol) + abs(of_haze) + abs(of_fog);
                float pick = draw() * of_all;
                int which = m.slot;
                vec3 scattering = vec3(m.cloud);
                float of_which = of_cloud;
                pick -= abs(of_cloud);
                if (pick >= 0.0) {
                    which = medium_rayleigh;
                    scattering = m.rayleigh;
                    of_which = of_rayleigh;
                    pick -= abs(of_rayleigh);
                }
                if (pick >= 0.0) {
                    which = medium_aerosol;
                    scattering = vec3(m.aerosol);
                    of_which = of_aerosol;
                    pick -= abs(of_aerosol);
                }
                if (pick >= 0.0) {
                    which = medium_haze;
                    scattering = vec3(m.haze);
                    of_which = of_haze;
                    pick -= abs(of_haze);
                }
                if (pick >= 0.0) {
                    which = medium_fog;
                    scattering = vec3(m.fog);
                    of_which = of_fog;
                }
                vec3 relative = base * scattering / max(abs(of_which), 1e-30);
                if (state == at_view) {
                    /* One of all collisions along the ray is kept, each with its share: a reservoir (Chao 1982). */
                    float share = of_all / most;
                    chosen_sum += share;
                    if (draw() * chosen_sum < share) {
                        chosen_weight = relative;
                        chosen_m = ray_m;
                        chosen_medium = which;
                    }
                    float dense = through_cloud * (m.cloud + m.cloud_loss) / most;
                    cloud_m += dense * ray_m;
                    cloud_weight += dense;
                    through_cloud *= 1.0 - (m.cloud + m.cloud_loss) / most;
                    through *= kept;
                    float size = max(abs(through.r), max(abs(through.g), abs(through.b)));
                    if (size < 0.02) {
                        bool stays = size > 0.0 && draw() < 0.25;
                        through *= stays ? 4.0 : 0.0;
                        through_cloud *= stays ? 4.0 : 0.0;
                        left_m = stays ? left_m : 0.0;
                        grounded = stays && grounded;
                        s.left_m = left_m > 0.0 ? s.left_m : 0.0;
                    }
                } else {
                    float total = of_all + of_loss + of_none;
                    float event = draw() * total;
                    if (event < of_all) {
                        weight = relative * (total / most);
                        medium = which;
                        collides = true;
                    } else if (event < of_all + of_loss) {
                        ends = true;
                    } else {
                        weight = base * kept * (total / max(of_none, 1e-30));
                    }
                }
            }
        }

        /* The end of a ray. */
        bool from_ground = false;
        bool over = left_m <= 0.0 && !collides && !ends;
        if (over && state == at_view) {
            vec3 out_through = through;
            if (grounded && draws_ground) {
                vec3 lit = through * eye.ground.rgb;
                float share = mean(abs(lit));
                chosen_sum += share;
                if (draw() * chosen_sum < share) {
                    chosen_weight = lit / share;
                    chosen_m = ray_m;
                    chosen_medium = medium_ground;
                }
                out_through = vec3(0.0);
            }
            through = out_through;
            ends = chosen_sum <= 0.0;
            collides = !ends;
            weight = chosen_weight * chosen_sum;
            medium = chosen_medium;
            r = origin + d * chosen_m;
        } else if (over && state == at_flight) {
            weight *= eye.ground.rgb;
            collides = grounded && mean(abs(weight)) > 0.0;
            ends = !collides;
            medium = medium_ground;
        } else if (over && state == at_sun) {
            light += sun_light;
            scatters = true;
        }

        for (int once = collides ? 0 : 1; once < 1; ++once) {
            ++order;
            incoming = d;
            velum_place place = place_of(r);
            vec3 normal = vec3(place.nx, place.ny, place.nz);
            bool on_ground = medium == medium_ground;
            r -= on_ground ? normal * place.height_m : vec3(0.0);
            float radius = max(eye.sun_lx.w, 1e-6);
            float half_sine = sin(0.5 * radius);
            vec3 sun = turned(eye.sun.xyz, draw() * 2.0 * half_sine * half_sine, draw());
            float phase = velum_phase_lobes_turn(medium_phase(medium), turn_between(incoming, sun));
            phase = on_ground ? max(dot(normal, sun), 0.0) / PI : phase;
            sun_light = weight * eye.sun_lx.rgb * phase;
            bool hidden;
            float length_m = ray_length(r, sun, on_ground, hidden);
            bool seen = !hidden && any(greaterThan(abs(sun_light), vec3(0.0)));
            d = sun;
            left_m = seen ? length_m : 0.0;
            origin = r; /* of the collision, to come back to */
            s.left_m = s.tile_m = 0.0;
            state = at_sun;
            if (seen && length_m <= 0.0) {
                light += sun_light;
            }
            scatters = !(seen && length_m > 0.0);
        }

        for (int once = scatters ? 0 : 1; once < 1; ++once) {
            r = origin;
            from_ground = medium == medium_ground;
            /* Half of those that have come so far go on, at each power of two. */
            bool fork = order >= 4096 && (order & (order - 1)) == 0;
            bool dropped = order == greatest_order || (fork && draw() < 0.5);
            weight *= fork ? 2.0 : 1.0;
            velum_place place = place_of(r);
            vec3 normal = vec3(place.nx, place.ny, place.nz);
            velum_phase_lobes lobes = medium_phase(medium);
            float choice = draw();
            float u = draw();
            float round = draw();
            float turn = 0.0;
            for (int air = from_ground ? 1 : 0; air < 1; ++air) {
                turn = velum_phase_lobes_sample(lobes, choice, u);
            }
            float cosine = sqrt(u);
            turn = from_ground ? 1.0 - cosine : turn;
            d = turned(from_ground ? normal : incoming, turn, round);
            /* The forward peak of what comes next makes directions near the sun's rare and bright. A second flight is
             * drawn about the sun now and then, and the two share what both can give (balance heuristic, Veach 1995). */
            for (int branch = branching > 0.0 && !waiting && !dropped ? 0 : 1; branch < 1; ++branch) {
                float own = from_ground ? max(dot(normal, d), 0.0) / PI
                                        : velum_phase_lobes_turn(lobes, turn_between(incoming, d));
                float lobe = velum_phase_hg_turn(turn_between(d, eye.sun.xyz), branch_g);
                vec3 whole = weight;
                weight = whole * (own / (own + branching * lobe));
                float about = draw();
                float b_u = draw();
                float b_round = draw();
                if (about < branching) {
                    vec3 to = turned(eye.sun.xyz, velum_phase_hg_sample(branch_g, b_u), b_round);
                    float b_own = from_ground ? max(dot(normal, to), 0.0) / PI
                                              : velum_phase_lobes_turn(lobes, turn_between(incoming, to));
                    float b_lobe = velum_phase_hg_turn(turn_between(to, eye.sun.xyz), branch_g);
                    waiting = true;
                    waiting_r = r;
                    waiting_d = d;
                    waiting_weight = weight;
                    waiting_order = order;
                    waiting_from_ground = from_ground;
                    d = to;
                    weight = whole * (b_own / (b_own + branching * b_lobe));
                }
            }
            /* Roulette of what carries little, as seen by what it can still bring. */
            float worth = mean(abs(weight));
            if (branching > 0.0) {
                worth *= 1.0 + 6.0 * velum_phase_hg_turn(turn_between(d, eye.sun.xyz), branch_g);
            }
            if (!dropped && worth < view.march.w) {
                float stay = max(worth / view.march.w, 1e-6);
                dropped = draw() >= stay;
                weight /= stay;
            }
            left_m = ray_length(r, d, from_ground, grounded);
            s.left_m = s.tile_m = 0.0;
            state = at_flight;
            ends = dropped || left_m <= 0.0;
        }

        for (int once = ends ? 0 : 1; once < 1; ++once) {
            if (waiting) {
                waiting = false;
                r = waiting_r;
                d = waiting_d;
                weight = waiting_weight;
                order = waiting_order;
                left_m = ray_length(r, d, waiting_from_ground, grounded);
                s.left_m = s.tile_m = 0.0;
                state = at_flight;
                /* Nothing to fly through: the next round ends it. */
            } else {
                vec4 a = vec4(light, cloud_m);
                vec4 b = vec4(through, cloud_weight);
                paths[path_index].light = is_bad(a) ? vec4(0.0) : a;
                paths[path_index].through = is_bad(b) ? vec4(0.0) : b;
                ++finished;
                state = at_start;
                left_m = 0.0;
                s.left_m = 0.0;
                s.most_1_m = 0.0;
            }
        }
    }
    for (int once = most_rounds < 0x7fffffffu ? 0 : 1; once < 1; ++once) {
        velum_reference_lane lane;
        lane.state = uvec4(uint(state), path_index, key, drawn);
        lane.flags = uvec4(uint(order), uint(waiting_order), uint(medium) | (uint(chosen_medium) << 8u),
                           (grounded ? 1u : 0u) | (host_solid ? 2u : 0u) | (waiting ? 4u : 0u) |
                               (waiting_from_ground ? 8u : 0u));
        lane.tile = uvec4(s.slots, s.tile.entry, floatBitsToUint(s.tile_m), 0u);
        lane.r = vec4(r, left_m);
        lane.d = vec4(d, ray_m);
        lane.stretch = vec4(s.left_m, s.most_1_m, chosen_m, cloud_weight);
        lane.weight = vec4(weight, through_cloud);
        lane.light = vec4(light, chosen_sum);
        lane.through = vec4(through, cloud_m);
        lane.origin = vec4(origin, 0.0);
        lane.chosen = vec4(chosen_weight, 0.0);
        lane.incoming = vec4(incoming, 0.0);
        lane.sun = vec4(sun_light, 0.0);
        lane.waiting_r = vec4(waiting_r, 0.0);
        lane.waiting_d = vec4(waiting_d, 0.0);
        lane.waiting_weight = vec4(waiting_weight, 0.0);
        lanes[own] = lane;
    }
    atomicAdd(slice[VELUM_SLICE_DONE], finished);
    atomicAdd(counters[0], begun);
    atomicAdd(counters[1], samples);
    atomicAdd(counters[2], light_samples);
    atomicAdd(counters[3], missing ? 1u : 0u);
    atomicAdd(counters[VELUM_COUNTER_ABOVE], above);
}
