/* Arrays of words in and out, one invocation for each case. */
layout(local_size_x = 64) in;
layout(set = 0, binding = 0, std430) readonly buffer input_buffer {
    uint input_words[];
};
layout(set = 0, binding = 1, std430) writeonly buffer output_buffer {
    uint output_words[];
};
layout(push_constant) uniform arguments {
    uint invocations;
};
