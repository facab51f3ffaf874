/* Eyes, views and shadow maps: made and destroyed. What the device may still use is buried, and freed when the device
 * has passed it. */
#include <stdlib.h>
#include <string.h>

#include "budget.h"
#include "handle.h"

static void free_eye(eye *y) {
    engine *e = y->e;
    tiles_finish(&y->tiles, &e->tables);
    gpu_image_finish(&e->g, &y->sky);
    free(y);
}

static void free_view(engine *e, view *v) {
    view_images_finish(&e->g, v);
    free(v);
}

static void free_shadow(shadow *s) {
    tiles_finish(&s->tiles, &s->e->tables);
    gpu_image_finish(&s->e->g, &s->image);
    gpu_image_finish(&s->e->g, &s->spare);
    free(s);
}

void objects_bury(engine *e) {
    noise_volumes_bury(e);
    for (eye **at = &e->dead_eyes; *at;) {
        eye *y = *at;
        if (y->last_serial <= e->completed_serial) {
            *at = y->next;
            free_eye(y);
        } else {
            at = &y->next;
        }
    }
    for (view **at = &e->dead_views; *at;) {
        view *v = *at;
        if (v->last_serial <= e->completed_serial) {
            *at = v->next;
            free_view(e, v);
        } else {
            at = &v->next;
        }
    }
    for (shadow **at = &e->dead_shadows; *at;) {
        shadow *s = *at;
        if (s->last_serial <= e->completed_serial) {
            *at = s->next;
            free_shadow(s);
        } else {
            at = &s->next;
        }
    }
}

static bool is_idle(checker *check, const engine *e) {
    return (e->state == ENGINE_IDLE && !e->inside) || check_fail(check, VELUM_ERROR_STATE, "not legal inside a frame");
}

velum_result eye_create(engine *e, const velum_eye_desc *desc, velum_eye **out) {
    checker check = {&e->sink, "engine", "create_eye", VELUM_OK};
    velum_eye_desc d;
    if (!check_pointer(&check, "out", out) || !is_idle(&check, e) ||
        !check_in(&check, "desc", &d, sizeof d, desc, V1_EYE_DESC) ||
        !check_flags(&check, "desc.flags", d.flags, VELUM_EYE_STUDY) ||
        !check_zero(&check, "desc.reserved", d.reserved) ||
        !check_range(&check, "desc.quality", d.quality, VELUM_QUALITY_DEFAULT, VELUM_QUALITY_REFERENCE)) {
        return check.result;
    }
    if (!budget_check(&check, &d)) {
        return check.result;
    }
    bool is_reference = d.quality == VELUM_QUALITY_REFERENCE;
    bool has_study = (d.flags & VELUM_EYE_STUDY) != 0;
    if (is_reference && has_study) {
        check_fail(&check, VELUM_ERROR_FLAGS, "desc.flags: VELUM_EYE_STUDY is not for VELUM_QUALITY_REFERENCE");
        return check.result;
    }
    if (is_reference || has_study) {
        velum_result result = is_reference ? reference_enable(e) : pipelines_add_study(&e->passes, &e->g);
        if (result < 0) {
            return result;
        }
    }
    eye *y = calloc(1, sizeof *y);
    if (!y) {
        check_fail(&check, VELUM_ERROR_OUT_OF_MEMORY, "no memory");
        return check.result;
    }
    y->e = e;
    y->has_study = has_study;
    y->quality = d.quality == VELUM_QUALITY_DEFAULT ? VELUM_QUALITY_MEDIUM : d.quality;
    budget_init(y, &d);
    if (!gpu_image_init_storage(&e->g, &y->sky, VK_FORMAT_R16G16B16A16_SFLOAT, VELUM_SKY_COLUMNS, VELUM_SKY_H)) {
        free_eye(y);
        return gpu_result(&e->g);
    }
    y->handle = handle_create(HANDLE_EYE, y, e->handle, &e->sink);
    if (!y->handle) {
        free_eye(y);
        check_fail(&check, VELUM_ERROR_OUT_OF_MEMORY, "too many objects");
        return check.result;
    }
    y->next = e->eyes;
    e->eyes = y;
    e->eye_count++;
    *out = y->handle;
    return VELUM_OK;
}

velum_result eye_destroy(eye *y) {
    engine *e = y->e;
    checker check = {&e->sink, "eye", "destroy_eye", VELUM_OK};
    if (!is_idle(&check, e)) {
        return check.result;
    }
    if (y->view_count > 0) {
        check_fail(&check, VELUM_ERROR_STATE, "%u views of it live", y->view_count);
        return check.result;
    }
    handle_destroy(y->handle);
    for (eye **at = &e->eyes; *at; at = &(*at)->next) {
        if (*at == y) {
            *at = y->next;
            break;
        }
    }
    e->eye_count--;
    y->next = e->dead_eyes;
    e->dead_eyes = y;
    objects_bury(e);
    return VELUM_OK;
}

static uint64_t bytes_of(const gpu_image *image) {
    return image->allocation.size;
}

velum_result view_create(eye *y, const velum_view_desc *desc, velum_view **out) {
    engine *e = y->e;
    checker check = {&e->sink, "eye", "create_view", VELUM_OK};
    velum_view_desc d;
    if (!check_pointer(&check, "out", out) || !is_idle(&check, e) ||
        !check_in(&check, "desc", &d, sizeof d, desc, V1_VIEW_DESC) || !check_flags(&check, "desc.flags", d.flags, 0) ||
        !check_count(&check, "desc.width", d.width, 1, VIEW_SIDE_MOST) ||
        !check_count(&check, "desc.height", d.height, 1, VIEW_SIDE_MOST)) {
        return check.result;
    }
    view *v = calloc(1, sizeof *v);
    if (!v) {
        check_fail(&check, VELUM_ERROR_OUT_OF_MEMORY, "no memory");
        return check.result;
    }
    v->eye = y;
    v->width = d.width;
    v->height = d.height;
    strncpy(v->name, d.name && d.name[0] ? d.name : "view", sizeof v->name - 1);
    if (!view_images_init(v)) {
        free_view(e, v);
        return gpu_result(&e->g);
    }
    v->handle = handle_create(HANDLE_VIEW, v, y->handle, &e->sink);
    if (!v->handle) {
        free_view(e, v);
        check_fail(&check, VELUM_ERROR_OUT_OF_MEMORY, "too many objects");
        return check.result;
    }
    y->view_count++;
    *out = v->handle;
    return VELUM_OK;
}

velum_result view_destroy(view *v) {
    engine *e = v->eye->e;
    checker check = {&e->sink, v->name, "destroy_view", VELUM_OK};
    if (!is_idle(&check, e)) {
        return check.result;
    }
    handle_destroy(v->handle);
    stats_forget(e, v);
    v->eye->view_count--;
    v->eye = NULL;
    v->next = e->dead_views;
    e->dead_views = v;
    objects_bury(e);
    return VELUM_OK;
}

velum_result shadow_create(engine *e, const velum_shadow_desc *desc, velum_shadow **out) {
    checker check = {&e->sink, "engine", "create_shadow", VELUM_OK};
    velum_shadow_desc d;
    if (!check_pointer(&check, "out", out) || !is_idle(&check, e) ||
        !check_in(&check, "desc", &d, sizeof d, desc, V1_SHADOW_DESC) ||
        !check_flags(&check, "desc.flags", d.flags, 0) || !check_zero(&check, "desc.reserved", d.reserved) ||
        !check_count(&check, "desc.levels", d.levels, 0, SHADOW_LEVELS_MAX) ||
        (d.texels != 0 && !check_count(&check, "desc.texels", d.texels, 64, 1024)) ||
        (d.extent_m != 0.0f && !check_range(&check, "desc.extent_m", (double)d.extent_m, 1000.0, 100000.0))) {
        return check.result;
    }
    if (d.texels % 16 != 0) {
        check_fail(&check, VELUM_ERROR_ARGUMENT, "desc.texels: found %u, expected a multiple of 16", d.texels);
        return check.result;
    }
    shadow *s = calloc(1, sizeof *s);
    if (!s) {
        check_fail(&check, VELUM_ERROR_OUT_OF_MEMORY, "no memory");
        return check.result;
    }
    s->e = e;
    s->levels = d.levels ? d.levels : 3;
    s->texels = d.texels ? d.texels : 256;
    s->extent_m = d.extent_m != 0.0f ? (double)d.extent_m : 8192.0;
    gpu_image_desc image = {.format = VK_FORMAT_R16_SFLOAT,
                            .type = VK_IMAGE_TYPE_2D,
                            .view_type = VK_IMAGE_VIEW_TYPE_2D_ARRAY,
                            .extent = {s->texels, s->texels, 1},
                            .layers = s->levels,
                            .usage = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_SAMPLED_BIT |
                                     VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT};
    bool has_image = gpu_image_init(&e->g, &s->image, &image);
    image.layers = 1;
    if (!has_image || !gpu_image_init(&e->g, &s->spare, &image)) {
        free_shadow(s);
        return gpu_result(&e->g);
    }
    s->handle = handle_create(HANDLE_SHADOW, s, e->handle, &e->sink);
    if (!s->handle) {
        free_shadow(s);
        check_fail(&check, VELUM_ERROR_OUT_OF_MEMORY, "too many objects");
        return check.result;
    }
    s->bytes = bytes_of(&s->image) + bytes_of(&s->spare);
    s->next = e->shadows;
    e->shadows = s;
    e->shadow_count++;
    *out = s->handle;
    return VELUM_OK;
}

velum_result shadow_destroy(shadow *s) {
    engine *e = s->e;
    checker check = {&e->sink, "shadow", "destroy_shadow", VELUM_OK};
    if (!is_idle(&check, e)) {
        return check.result;
    }
    handle_destroy(s->handle);
    for (shadow **at = &e->shadows; *at; at = &(*at)->next) {
        if (*at == s) {
            *at = s->next;
            break;
        }
    }
    if (e->newest_shadow == s) {
        e->newest_shadow = NULL;
        for (shadow *other = e->shadows; other; other = other->next) {
            e->newest_shadow = other->drawn ? other : e->newest_shadow;
        }
    }
    e->shadow_count--;
    s->next = e->dead_shadows;
    e->dead_shadows = s;
    objects_bury(e);
    return VELUM_OK;
}
