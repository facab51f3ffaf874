/* Pictures of VELUM_QUALITY_REFERENCE are kept by this number (tests/accuracy/reference.h), which is looked for in the
 * plugin's file: whatever was built when, it tells what made them. */
#include "accuracy_revision.h"

__attribute__((used)) static const char revision[] = "velum reference revision " ACCURACY_REVISION;
