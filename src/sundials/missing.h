/* What the sundials-sys bindings lack: the flag constants by name, the version that the headers are of, and the functions
 * that exist in one major version only. build.rs reads this file; a header that is absent or too old is noticed there. */
#if __has_include(<sundials/sundials_config.h>)
#include <sundials/sundials_config.h>
#if SUNDIALS_VERSION_MAJOR >= 6
#include <sundials/sundials_version.h>
#include <sundials/sundials_linearsolver.h>
#if __has_include(<cvodes/cvodes.h>)
#include <cvodes/cvodes.h>
#endif
#if __has_include(<kinsol/kinsol.h>)
#include <kinsol/kinsol.h>
#endif
#endif
#endif
