"""layout.py PREFIX OUT.c HEADER...: a table of every struct field and constant that the headers declare, with offsets,
sizes and the text of the declaration, as C source."""
import re
import sys

prefix, out_path, headers = sys.argv[1], sys.argv[2], sys.argv[3:]
fields, structs, constants = [], [], []


def split_declarators(text):
    """`const float a, *b[3]` -> (name, declaration) for each."""
    base, parts, depth = text, [], 0
    for part in re.split(r',(?![^(]*\))', text):
        parts.append(part.strip())
    first = parts[0]
    name = re.search(r'(\w+)\s*((?:\[[^]]*\]\s*)*)$', first)
    base = first[:name.start(1)].rstrip(' *')
    for i, part in enumerate(parts):
        match = re.search(r'(\w+)\s*((?:\[[^]]*\]\s*)*)$', part)
        declaration = part if i == 0 else base + ' ' + part
        yield match.group(1), declaration


for header in headers:
    with open(header, encoding='utf-8') as file:
        text = file.read()
    text = re.sub(r'/\*.*?\*/', ' ', text, flags=re.S)
    text = re.sub(r'//[^\n]*', ' ', text)
    for match in re.finditer(r'^#define[ \t]+(VELUM_\w+)[ \t]+(0x[0-9a-fA-F]+u?|\d+u?)[ \t]*$', text, flags=re.M):
        constants.append(match.group(1))
    for match in re.finditer(r'\benum\s*\{([^}]*)\}', text):
        constants += re.findall(r'\b(VELUM_\w+)\b', match.group(1))
    for match in re.finditer(r'typedef struct (\w+) \{(.*?)\n\} (\w+);', text, flags=re.S):
        name, body = match.group(3), match.group(2)
        structs.append(name)
        for declaration in body.split(';'):
            declaration = re.sub(r'\s+', ' ', declaration).strip()
            if not declaration:
                continue
            function = re.search(r'\( ?VELUM_CALL ?\* ?(\w+)\)', declaration)
            if function:
                fields.append((name, function.group(1), declaration))
            else:
                fields += [(name, field, whole) for field, whole in split_declarators(declaration)]

if not structs or not fields or not constants:
    sys.exit('layout.py: found nothing in ' + ' '.join(headers))
with open(out_path, 'w', encoding='utf-8') as out:
    out.write('#include <stddef.h>\n#include <velum/velum.h>\n#include <velum/vulkan.h>\n#include "layout.h"\n')
    out.write(f'const layout_struct {prefix}_structs[] = {{\n')
    for name in structs:
        out.write(f'    {{"{name}", sizeof({name})}},\n')
    out.write(f'}};\nconst uint32_t {prefix}_struct_count = {len(structs)};\n')
    out.write(f'const layout_field {prefix}_fields[] = {{\n')
    for name, field, declaration in fields:
        out.write(f'    {{"{name}", "{field}", "{declaration}", offsetof({name}, {field}), '
                  f'sizeof((({name} *)0)->{field})}},\n')
    out.write(f'}};\nconst uint32_t {prefix}_field_count = {len(fields)};\n')
    out.write(f'const layout_constant {prefix}_constants[] = {{\n')
    for name in constants:
        out.write(f'    {{"{name}", (int64_t){name}}},\n')
    out.write(f'}};\nconst uint32_t {prefix}_constant_count = {len(constants)};\n')
