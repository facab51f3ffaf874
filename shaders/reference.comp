#version 460
#extension GL_GOOGLE_include_directive : require
/* The reference: paths of light from the eye through every order of scattering. Unbiased: collisions by delta tracking
 * (Woodcock et al. 1965) against bounds of stretches, light of the sun by ratio tracking (Novak et al. 2014), three
 * channels at once with probabilities that know the path's history (Kutz et al. 2017), so that their weights stay
 * within three times their mean. An invocation makes paths as long as there are any: a tight loop tracks them, and what
 * happens at their ends is done for many lanes at once. Each path's numbers depend on its pixel and its own number
 * alone. */
#include "shared/reference.h"
layout(set = 1, binding = VELUM_BIND_REFERENCE_ERROR, std430) buffer slice_buffer {
    uint slice[VELUM_SLICE_WORDS];
};
#define VELUM_NOTHING slice[VELUM_SLICE_NOTHING]
#include "reference_path.glsl"
layout(local_size_x_id = 1, local_size_y = 1) in;
layout(set = 1, binding = VELUM_BIND_REFERENCE_PATHS, std430) writeonly buffer paths_buffer {
    velum_reference_path paths[];
};
layout(set = 1, binding = VELUM_BIND_REFERENCE_LANES, std430) buffer lanes_buffer {
    velum_reference_lane lanes[];
};
layout(set = 1, binding = VELUM_BIND_COUNTERS, std430) buffer counter_buffer {
    uint counters[VELUM_COUNTER_WORDS];
};

/* What an invocation is at. */
const int at_start = 0;   /* of a path */
const int at_view = 1;    /* along the pixel's ray, through all of it: its transmittance, and where it scatters first */
const int at_flight = 2;  /* to the next collision */
const int at_sun = 3;     /* from a collision towards the sun */
const int at_scatter = 4; /* where the pixel's ray has met something */
const int at_end = 5;     /* no path is left */

const int tracking_rounds = 4;
/* Orders from which half of the paths go on at each power of two. */
const int first_fork = 4096;
/* How many flights to the sun are worth it for light scattered evenly. */
const float sun_worth = 2.0;
/* Of flights about the sun, in air and on the ground. */
const float outside_branching = 0.2;
/* Orders up to which flights about the sun are drawn from the whole phase function; beyond, from its narrow peak alone:
 * what is drawn for wide lobes thins out the flights of all directions, and on a long way through a deep layer they
 * would die out, or multiply, by chance. */
const int last_wide = 12;
/* 1 - cos of the angle from the sun beyond which late flights are not drawn: a narrow lobe's far tail does the same over
 * a thousand orders. */
const float late_cone = 0.0025;
/* Bounds of air are raised for rays that must meet it in many places (the pixel's), or in some (to the sun). */
const float view_air = 10.0;
const float sun_air = 3.0;

float air_m;   /* to where air is looked at next */
float air_1_m; /* its bound, 0: only a new bound is due there */

/* From a place on, the bound of air holds as far as air_m. */
void air_from(float h, float rise, int state) {
    if (velum_has_air) {
        float reach_m;
        float most = air_most(h, rise, reach_m) * (state == at_view ? view_air : state == at_sun ? sun_air : 1.0);
        float free_m = most > 0.0 ? -log(1.0 - draw()) / most : far_m;
        air_1_m = free_m < reach_m ? most : 0.0;
        air_m = min(free_m, reach_m);
    }
}

ivec2 pixel_of(uint path) {
    uint place = velum_reference_pixel_of(view.march_size.x + path / view.march_size.z, view.steps.y, view.size.x);
    return ivec2(int(place & 0xffffu), int(place >> 16u));
}

void ray_from(vec3 r, vec3 d, int state) {
    velum_place place = place_of(r);
    float rise = dot(vec3(place.nx, place.ny, place.nz), d);
    clear_from(place.height_m, rise);
    air_from(place.height_m, rise, state);
}

/* Of all collisions along the pixel's ray some are kept, each with its share: reservoirs (Chao 1982), whose numbers are
 * spread evenly. */
#define VELUM_CHOOSE_ONE(SHARE, WEIGHT, MEDIUM)                                                                        \
    for (int i = 0; i < VELUM_REFERENCE_CHAINS; ++i) {                                                                 \
        bool own = chosen_sum <= (SHARE) ||                                                                            \
                   fract(event + float(i) / float(VELUM_REFERENCE_CHAINS)) * chosen_sum < (SHARE);                     \
        chosen[i] = own ? vec4(WEIGHT, ray_m) : chosen[i];                                                             \
        uint shift = 8u * uint(i);                                                                                     \
        chosen_media = own ? (chosen_media & ~(255u << shift)) | (uint(MEDIUM) << shift) : chosen_media;               \
    }

void main() {
    const int greatest_order = int(view.steps.x + VELUM_NOTHING);
    const float branching = view.march.x + float(VELUM_NOTHING); /* sunward branches for each collision, at most */
    const bool draws_ground = view_flag(VELUM_VIEW_BLOCK_GROUND);
    const uint count = view.march_size.y * view.march_size.z;

    int state = at_start;
    uint path_index = 0u;
    vec3 r = vec3(0.0);
    vec3 d = vec3(0.0, 0.0, 1.0);
    float left_m = 0.0;
    bool grounded = false;    /* the ray ends on the ground */
    vec3 tracked = vec3(0.0); /* transmittance, weight of a flight, or light of the sun */
    float dim = 0.0;          /* roulette begins below */
    vec3 light = vec3(0.0);
    int order = 0;
    /* Along the pixel's ray. */
    float ray_m = 0.0;
    vec3 through = vec3(1.0);
    float through_cloud = 1.0;
    float chosen_sum = 0.0;
    vec4 chosen[VELUM_REFERENCE_CHAINS]; /* weight, distance */
    uint chosen_media = 0u;              /* bytes */
    int chain = 0;
    float cloud_m = 0.0;
    float cloud_weight = 0.0;
    /* The newest collision, and the flight from there. */
    vec3 origin = vec3(0.0);
    int medium = 0;
    vec3 next_d = vec3(0.0);
    vec3 next_weight = vec3(0.0);
    bool next = false;
    /* Flights that wait while branches from them are followed, the newest last. */
    velum_reference_flight flights[VELUM_REFERENCE_FLIGHTS];
    int waiting = 0;

    uint samples = 0u;
    uint light_samples = 0u;
    uint above = 0u;
    uint bad = 0u;
    uint begun = 0u;
    uint finished = 0u;
    bool missing = false;
    air_m = far_m;
    air_1_m = 0.0;
    bounds_begin();

    /* Software devices give up loops after some 65,000 rounds, all loops of an invocation together: a lane stops before
     * that, and goes on where it was in the next dispatch. */
    const uint own = gl_GlobalInvocationID.x;
    const uint most_rounds = view.steps.w + VELUM_NOTHING;
    if (view.steps.z + VELUM_NOTHING != 0u) {
        velum_reference_lane lane = lanes[own];
        state = int(lane.state.x);
        path_index = lane.state.y;
        key = lane.state.z;
        drawn = lane.state.w;
        order = int(lane.flags.x);
        waiting = int(lane.flags.y);
        medium = int(lane.flags.z & 255u);
        chain = int(lane.flags.z >> 8u);
        grounded = (lane.flags.w & 1u) != 0u;
        next = (lane.flags.w & 2u) != 0u;
        r = lane.r.xyz;
        left_m = lane.r.w;
        d = lane.d.xyz;
        ray_m = lane.d.w;
        clear_m[0] = lane.clear_0.x;
        clear_m[1] = lane.clear_0.y;
        clear_m[2] = lane.clear_0.z;
        clear_m[3] = lane.clear_0.w;
        clear_m[4] = lane.clear_4.x;
        clear_m[5] = lane.clear_4.y;
        clear_m[6] = lane.clear_4.z;
        clear_m[7] = lane.clear_4.w;
#ifdef VELUM_FRINGED
        clear_m[process_hem] = uintBitsToFloat(lane.media.z);
        clear_m[process_fall] = uintBitsToFloat(lane.media.w);
#endif
        for (int i = 0; i < 4; ++i) {
            own_most_1_m[i] = lane.own_0[i];
            own_most_1_m[4 + i] = lane.own_4[i];
        }
#ifdef VELUM_FRINGED
        own_most_1_m[process_hem] = lane.held.y;
        own_most_1_m[process_fall] = lane.held.z;
#endif
        held_m = lane.held.x;
        tracked = lane.tracked.xyz;
        air_m = lane.tracked.w;
        light = lane.light.xyz;
        chosen_sum = lane.light.w;
        through = lane.through.xyz;
        through_cloud = lane.through.w;
        origin = lane.origin.xyz;
        cloud_m = lane.origin.w;
        for (int i = 0; i < VELUM_REFERENCE_CHAINS; ++i) {
            chosen[i] = lane.chosen[i];
        }
        chosen_media = lane.media.x;
        cloud_weight = uintBitsToFloat(lane.media.y);
        next_d = lane.next_d.xyz;
        next_weight = lane.next.xyz;
        dim = lane.next_d.w;
        air_1_m = lane.next.w;
        for (int i = 0; i < VELUM_REFERENCE_FLIGHTS; ++i) {
            flights[i] = lane.flights[i];
        }
    }

    for (uint round = 0u; state != at_end && round < most_rounds; ++round) {
        for (int once = state == at_start ? 0 : 1; once < 1; ++once) {
            path_index = atomicAdd(slice[VELUM_SLICE_BEGUN], 1u);
            if (path_index >= count) {
                state = at_end;
                break;
            }
            ++begun;
            ivec2 pixel = pixel_of(path_index);
            if (pixel.x >= int(view.size.x) || pixel.y >= int(view.size.y)) {
                ++finished;
                break;
            }
            key = velum_hash_4(uint(pixel.y) * view.size.x + uint(pixel.x), view.march_size.w + path_index % view.march_size.z, view.frame.w, 0x7261790au);
            drawn = 0u;
            view_ray ray = view_ray_at(vec2(pixel) + 0.5 + view.scale.yz);
            r = ray.origin;
            d = ray.direction;
            left_m = view_length(r, d, grounded);
            float host_m = host_distance(pixel, ray);
            grounded = grounded && host_m < 0.0;
            left_m = host_m >= 0.0 ? min(host_m, left_m) : left_m;
            ray_m = 0.0;
            light = vec3(0.0);
            order = 0;
            tracked = vec3(1.0);
            dim = 0.05;
            through_cloud = 1.0;
            chosen_sum = 0.0;
            cloud_m = 0.0;
            cloud_weight = 0.0;
            waiting = 0;
            state = at_view;
            ray_from(r, d, state);
        }

        bool collides = false; /* at r, with `medium`; tracked is the weight of what scatters */
        bool over = left_m <= 0.0;
        bool ends = false; /* a flight has led nowhere */
        bool tracks = !over && state != at_start && state != at_scatter && state != at_end;
        for (int i = 0; i < tracking_rounds && tracks; ++i) {
            float step_m;
            float bound_1_m;
            int slot;
            bool by_air = velum_has_air && air_m < left_m;
            bool meets = cloud_advance(-log(1.0 - draw()), by_air ? air_m : left_m, draw(), step_m, bound_1_m, slot);
            over = !meets && !by_air;
            by_air = !meets && by_air;
            r += d * step_m;
            ray_m += step_m;
            left_m -= step_m;
            air_m -= step_m;
            tracks = !over;
            samples += tracks && state != at_sun ? 1u : 0u;
            light_samples += tracks && state == at_sun ? 1u : 0u;

            /* Shares of what was tried for that scatter, by medium, are lost, and pass. */
            for (int once = meets ? 0 : 1; once < 1; ++once) {
                float extinction = clouds_at(slot, r, d, FRINGED(draw(), 0.0), missing) / bound_1_m;
                float kept = 1.0 - extinction;
                above += kept < -1e-3 ? 1u : 0u;
                float scattering = slot >= VELUM_SLOT_UNIFORM ? extinction * eye.slots[slot].optics.x : extinction;
                float total = extinction + abs(kept);
                float share = greatest(tracked) > 0.0 ? mean(abs(tracked)) * scattering : 0.0;
                float event = draw();
                bool picked = event * total < scattering;
                if (state == at_view) {
                    chosen_sum += share;
                    VELUM_CHOOSE_ONE(share, tracked / mean(abs(tracked)), slot)
                    cloud_m += through_cloud * extinction * ray_m;
                    cloud_weight += through_cloud * extinction;
                    through_cloud *= kept;
                }
                collides = state == at_flight && picked;
                ends = state == at_flight && !picked && event * total < extinction;
                tracked *= state == at_flight ? (collides || kept > 0.0 ? total : -total) : kept;
                medium = collides ? slot : medium;
            }
            if (velum_has_air) {
                for (int once = by_air ? 0 : 1; once < 1; ++once) {
                    velum_place place = place_of(r);
                    for (int twice = air_1_m > 0.0 ? 0 : 1; twice < 1; ++twice) {
                        air_matter m = air_at(place.height_m);
                        float dust = m.aerosol + m.haze + m.fog;
                        vec3 kept = 1.0 - (m.rayleigh + m.loss + vec3(dust)) / air_1_m;
                        above += any(lessThan(kept, vec3(-1e-3))) ? 1u : 0u;
                        float size = mean(tracked);
                        float of_rayleigh = abs(mean(tracked * m.rayleigh)) / air_1_m;
                        float of_dust = abs(size) * dust / air_1_m;
                        float of_all = of_rayleigh + of_dust;
                        float of_loss = mean(abs(tracked) * m.loss) / air_1_m;
                        float total = of_all + of_loss + mean(abs(tracked * kept));
                        float event = draw();
                        float share = event * of_all; /* along the pixel's ray one is chosen in any case */
                        event *= total;
                        bool picked = event < of_all;
                        event = state == at_view ? share : event;
                        bool clean = event < of_rayleigh;
                        float pick = (event - of_rayleigh) / max(of_dust, 1e-30) * dust;
                        int which = clean                        ? medium_rayleigh
                                    : pick < m.aerosol           ? medium_aerosol
                                    : pick < m.aerosol + m.haze ? medium_haze
                                                                 : medium_fog;
                        vec3 relative = tracked * (clean ? m.rayleigh / max(of_rayleigh, 1e-30)
                                                         : vec3(dust / max(of_dust, 1e-30))) / air_1_m;
                        if (state == at_view) {
                            chosen_sum += of_all;
                            event = draw();
                            VELUM_CHOOSE_ONE(of_all, relative, which)
                        }
                        collides = state == at_flight && picked;
                        ends = state == at_flight && !picked && event < of_all + of_loss;
                        vec3 passed = tracked * kept;
                        passed *= state == at_flight ? total / max(mean(abs(passed)), 1e-30) : 1.0;
                        tracked = collides ? relative * total : passed;
                        medium = collides ? which : medium;
                    }
                    air_from(place.height_m, dot(vec3(place.nx, place.ny, place.nz), d), state);
                }
            }
            /* Roulette: what is dim is dropped most of the time, and else counts for more. */
            float size = greatest(tracked);
            if (tracks && state != at_flight && size < dim) {
                bool stays = size > 0.0 && draw() < 0.25;
                tracked *= stays ? 4.0 : 0.0;
                through_cloud *= state == at_sun ? 1.0 : stays ? 4.0 : 0.0;
                grounded = grounded && stays;
                over = over || !stays;
            }
            tracks = tracks && !collides && !ends && !over;
        }

        /* The end of a ray. */
        bool sunlit = false; /* the sun has been seen to */
        if (over && state == at_view) {
            through = tracked;
            if (grounded && draws_ground) {
                vec3 lit = through * eye.ground.rgb;
                float share = mean(abs(lit));
                chosen_sum += share;
                float event = draw();
                VELUM_CHOOSE_ONE(share, lit / share, medium_ground)
                through = vec3(0.0);
            }
            chain = 0;
            state = chosen_sum > 0.0 ? at_scatter : state;
            ends = chosen_sum <= 0.0;
        } else if (over && state == at_flight) {
            tracked *= eye.ground.rgb;
            collides = grounded && greatest(tracked) > 0.0;
            ends = !collides;
            medium = medium_ground;
        } else if (over && state == at_sun) {
            light += tracked;
            sunlit = true;
        }

        for (int once = state == at_scatter ? 0 : 1; once < 1; ++once) {
            view_ray ray = view_ray_at(vec2(pixel_of(path_index)) + 0.5 + view.scale.yz);
            d = ray.direction;
            vec4 one = chosen[0];
            for (int i = 1; i < VELUM_REFERENCE_CHAINS; ++i) {
                one = chain == i ? chosen[i] : one;
            }
            r = ray.origin + d * one.w;
            tracked = one.xyz * (chosen_sum / float(VELUM_REFERENCE_CHAINS));
            medium = int((chosen_media >> (8u * uint(chain))) & 255u);
            order = 0;
            collides = true;
        }

        for (int once = collides ? 0 : 1; once < 1; ++once) {
            ++order;
            bool on_ground = medium == medium_ground;
            velum_place place = place_of(r);
            vec3 normal = vec3(place.nx, place.ny, place.nz);
            r -= on_ground ? normal * place.height_m : vec3(0.0);
            origin = r;
            velum_phase_lobes lobes = medium_phase(medium);

            float half_sine = sin(0.5 * max(eye.sun_lx.w, 1e-6));
            vec3 sun = turned(eye.sun.xyz, draw() * 2.0 * half_sine * half_sine, draw());
            float rise = dot(normal, sun);
            float phase = on_ground ? max(rise, 0.0) / PI : velum_phase_lobes_turn(lobes, turn_between(d, sun));
            /* What the sun's light is worth here, over light scattered evenly: so often it is looked for. */
            float whole_weight = chosen_sum / float(VELUM_REFERENCE_CHAINS);
            float worth = 4.0 * PI * phase * mean(abs(tracked)) / whole_weight;
            float look = order == 1 ? 1.0 : min(worth * sun_worth, 1.0);
            bool looks = draw() < look && worth > 0.0;
            vec3 sun_light = tracked * eye.sun_lx.rgb * (phase / max(look, 1e-30));

            /* Half of those that have come so far go on, at each power of two. */
            bool fork = order >= first_fork && (order & (order - 1)) == 0;
            next = order != greatest_order && !(fork && draw() < 0.5);
            next_weight = tracked * (fork ? 2.0 : 1.0);
            float turn = 1.0 - sqrt(draw());
            vec3 axis = normal;
            for (int lobed = on_ground ? 1 : 0; lobed < 1; ++lobed) {
                turn = velum_phase_lobes_draw(lobes);
                axis = d;
            }
            /* Lambert's cosine is drawn as its own 1 - cos. */
            next_d = turned(axis, turn, draw());
            /* The forward peak of what comes next makes directions near the sun's rare and bright. A second flight is
             * drawn about the sun now and then, and the two share what both can give (balance heuristic, Veach 1995). */
            bool clouded = medium < VELUM_SLOT_COUNT;
            int narrow = clouded ? medium : int(view.march.y);
            velum_phase_lobes sunward = medium_phase(narrow);
            bool early = order <= last_wide;
            float rate = branching * (clouded ? min(worth * sun_worth, 1.0) : outside_branching);
            rate = early || narrow < VELUM_SLOT_UNIFORM ? rate : 0.0;
            sunward.weight_second = early ? sunward.weight_second : 0.0;
            for (int branch = rate > 0.0 && next ? 0 : 1; branch < 1; ++branch) {
                float given = on_ground ? max(dot(normal, next_d), 0.0) / PI
                                        : velum_phase_lobes_turn(lobes, turn_between(d, next_d));
                float cone = early ? 3.0 : late_cone;
                float aside = turn_between(next_d, eye.sun.xyz);
                float lobe = aside < cone ? velum_phase_lobes_turn(sunward, aside) : 0.0;
                /* Where no more can wait one of the two is drawn. */
                float either = waiting == VELUM_REFERENCE_FLIGHTS ? 1.0 + rate : 1.0;
                vec3 whole = next_weight * either;
                next_weight = whole * (given / (given + rate * lobe));
                bool second = draw() * either < rate;
                aside = second ? velum_phase_lobes_draw(sunward) : 0.0;
                if (second && aside >= cone) {
                    next = next && waiting < VELUM_REFERENCE_FLIGHTS;
                } else if (second) {
                    vec3 to = turned(eye.sun.xyz, aside, draw());
                    given = on_ground ? max(dot(normal, to), 0.0) / PI : velum_phase_lobes_turn(lobes, turn_between(d, to));
                    lobe = velum_phase_lobes_turn(sunward, turn_between(to, eye.sun.xyz));
                    velum_reference_flight first;
                    first.r = vec4(r, float(order));
                    first.d = vec4(next_d, on_ground ? 1.0 : 0.0);
                    first.weight = vec4(next_weight, 0.0);
                    for (int i = 0; i < VELUM_REFERENCE_FLIGHTS; ++i) {
                        if (waiting == i) {
                            flights[i] = first;
                        }
                    }
                    waiting = min(waiting + 1, VELUM_REFERENCE_FLIGHTS);
                    next_d = to;
                    next_weight = whole * (given / (given + rate * lobe));
                }
            }
            /* Roulette of what carries little, as seen by what it can still bring. */
            float bears = mean(abs(next_weight)) / whole_weight;
            if (clouded) {
                bears *= 1.0 + 6.0 * velum_phase_lobes_turn(sunward, turn_between(next_d, eye.sun.xyz));
            }
            if (bears < view.march.w) {
                float stay = max(bears / view.march.w, 1e-6);
                next = next && draw() < stay;
                next_weight /= stay;
            }

            /* To the sun first. */
            bool hidden = on_ground && rise <= 0.0;
            for (int seen = looks && !hidden ? 0 : 1; seen < 1; ++seen) {
                left_m = ray_length(r, sun, normal, on_ground, hidden);
            }
            sunlit = !looks || hidden;
            d = sun;
            tracked = sun_light;
            dim = 0.1 * greatest(sun_light);
            grounded = false;
            state = at_sun;
            ray_from(r, d, state);
        }

        bool flies = false;
        bool from_ground = medium == medium_ground;
        if (sunlit) {
            r = origin;
            d = next_d;
            tracked = next_weight;
            flies = next;
            ends = !next;
        }
        if (ends && waiting > 0) {
            --waiting;
            velum_reference_flight last = flights[0];
            for (int i = 1; i < VELUM_REFERENCE_FLIGHTS; ++i) {
                if (waiting == i) {
                    last = flights[i];
                }
            }
            r = last.r.xyz;
            order = int(last.r.w);
            d = last.d.xyz;
            from_ground = last.d.w > 0.0;
            tracked = last.weight.xyz;
            flies = true;
            ends = false;
        }
        for (int once = flies ? 0 : 1; once < 1; ++once) {
            velum_place place = place_of(r);
            left_m = ray_length(r, d, vec3(place.nx, place.ny, place.nz), from_ground, grounded);
            state = at_flight;
            ray_from(r, d, state);
        }
        if (ends && chosen_sum > 0.0 && chain + 1 < VELUM_REFERENCE_CHAINS) {
            ++chain;
            state = at_scatter;
            ends = false;
        }
        for (int once = ends ? 0 : 1; once < 1; ++once) {
            vec4 first = vec4(light, cloud_m);
            vec4 second = vec4(through, cloud_weight);
            bad += is_bad(first) || is_bad(second) ? 1u : 0u;
            paths[path_index].light = is_bad(first) ? vec4(0.0) : first;
            paths[path_index].through = is_bad(second) ? vec4(0.0) : second;
            ++finished;
            state = at_start;
        }
    }
    for (int once = most_rounds < 0x7fffffffu ? 0 : 1; once < 1; ++once) {
        velum_reference_lane lane;
        lane.state = uvec4(uint(state), path_index, key, drawn);
        lane.flags = uvec4(uint(order), uint(waiting), uint(medium) | (uint(chain) << 8u),
                           (grounded ? 1u : 0u) | (next ? 2u : 0u));
        lane.r = vec4(r, left_m);
        lane.d = vec4(d, ray_m);
        lane.clear_0 = vec4(clear_m[0], clear_m[1], clear_m[2], clear_m[3]);
        lane.clear_4 = vec4(clear_m[4], clear_m[5], clear_m[6], clear_m[7]);
        lane.tracked = vec4(tracked, air_m);
        lane.light = vec4(light, chosen_sum);
        lane.through = vec4(through, through_cloud);
        lane.origin = vec4(origin, cloud_m);
        for (int i = 0; i < VELUM_REFERENCE_CHAINS; ++i) {
            lane.chosen[i] = chosen[i];
        }
        lane.media = uvec4(chosen_media, floatBitsToUint(cloud_weight), FRINGED(floatBitsToUint(clear_m[process_hem]), 0u),
                           FRINGED(floatBitsToUint(clear_m[process_fall]), 0u));
        for (int i = 0; i < 4; ++i) {
            lane.own_0[i] = own_most_1_m[i];
            lane.own_4[i] = own_most_1_m[4 + i];
        }
        lane.held = vec4(held_m, FRINGED(own_most_1_m[process_hem], 0.0), FRINGED(own_most_1_m[process_fall], 0.0), 0.0);
        lane.next_d = vec4(next_d, dim);
        lane.next = vec4(next_weight, air_1_m);
        for (int i = 0; i < VELUM_REFERENCE_FLIGHTS; ++i) {
            lane.flights[i] = flights[i];
        }
        lanes[own] = lane;
    }
    atomicAdd(slice[VELUM_SLICE_DONE], finished);
    atomicAdd(counters[0], begun);
    atomicAdd(counters[1], samples);
    atomicAdd(counters[2], light_samples);
    atomicAdd(counters[3], missing ? 1u : 0u);
    atomicAdd(counters[VELUM_COUNTER_ABOVE], above);
    atomicAdd(counters[VELUM_COUNTER_BAD], bad);
}
