/* Pictures of VELUM_QUALITY_REFERENCE are kept by this number (tests/accuracy/reference.h), which is looked for in the
 * plugin's file: whatever was built when, it tells what made them. */
#include "accuracy_revision.h"

extern const char plugin_revision[];
__attribute__((used)) const char plugin_revision[] = "velum reference revision " ACCURACY_REVISION;
