#define BREAKWATER_KERNEL template
#include <breakwater/linear/eigen_kernels.h>
