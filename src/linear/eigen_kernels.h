// Eigen's largest templates for matrices of any size, compiled once: in eigen_kernels.cpp. The
// precompiled headers contain this, no header does.
#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>

#ifndef BREAKWATER_KERNEL
#define BREAKWATER_KERNEL extern template
#endif

namespace Eigen::internal {
using BreakwaterColumns = const_blas_data_mapper<double, Index, ColMajor>;
using BreakwaterRows = const_blas_data_mapper<double, Index, RowMajor>;
using BreakwaterResult = blas_data_mapper<double, Index, ColMajor, 0, 1>;
using BreakwaterSizes = gebp_traits<double, double>;

// Products of matrices.
BREAKWATER_KERNEL struct gebp_kernel<double, double, Index, BreakwaterResult, BreakwaterSizes::mr,
                                     BreakwaterSizes::nr, false, false>;
BREAKWATER_KERNEL struct gemm_pack_lhs<double, Index, BreakwaterColumns, BreakwaterSizes::mr,
                                       BreakwaterSizes::LhsProgress,
                                       BreakwaterSizes::LhsPacket4Packing, ColMajor>;
BREAKWATER_KERNEL struct gemm_pack_lhs<double, Index, BreakwaterRows, BreakwaterSizes::mr,
                                       BreakwaterSizes::LhsProgress,
                                       BreakwaterSizes::LhsPacket4Packing, RowMajor>;
BREAKWATER_KERNEL struct gemm_pack_rhs<double, Index, BreakwaterColumns, BreakwaterSizes::nr,
                                       ColMajor>;
BREAKWATER_KERNEL struct gemm_pack_rhs<double, Index, BreakwaterRows, BreakwaterSizes::nr,
                                       RowMajor>;
BREAKWATER_KERNEL struct gemm_pack_rhs<double, Index, BreakwaterResult, BreakwaterSizes::nr,
                                       ColMajor, false, true>;
BREAKWATER_KERNEL void evaluateProductBlockingSizesHeuristic<double, double, 1, Index>(Index&,
                                                                                       Index&,
                                                                                       Index&,
                                                                                       Index);
BREAKWATER_KERNEL void evaluateProductBlockingSizesHeuristic<double, double, 4, Index>(Index&,
                                                                                       Index&,
                                                                                       Index&,
                                                                                       Index);
BREAKWATER_KERNEL struct general_matrix_vector_product<Index, double, BreakwaterColumns, ColMajor,
                                                       false, double, BreakwaterRows, false>;
BREAKWATER_KERNEL struct general_matrix_vector_product<Index, double, BreakwaterRows, RowMajor,
                                                       false, double, BreakwaterColumns, false>;

// Triangular systems, LU and Cholesky.
BREAKWATER_KERNEL struct triangular_solve_matrix<double, Index, OnTheLeft, Lower, false, ColMajor,
                                                 ColMajor, 1>;
BREAKWATER_KERNEL struct triangular_solve_matrix<double, Index, OnTheLeft, UnitLower, false,
                                                 ColMajor, ColMajor, 1>;
BREAKWATER_KERNEL struct triangular_solve_matrix<double, Index, OnTheLeft, Upper, false, ColMajor,
                                                 ColMajor, 1>;
BREAKWATER_KERNEL struct triangular_solve_matrix<double, Index, OnTheLeft, Upper, false, RowMajor,
                                                 ColMajor, 1>;
BREAKWATER_KERNEL struct triangular_solve_matrix<double, Index, OnTheRight, Upper, false, RowMajor,
                                                 ColMajor, 1>;
BREAKWATER_KERNEL struct general_matrix_matrix_triangular_product<
    Index, double, ColMajor, false, double, RowMajor, false, ColMajor, 1, Lower>;
BREAKWATER_KERNEL struct partial_lu_impl<double, ColMajor, int>;
BREAKWATER_KERNEL struct llt_inplace<double, Lower>;
}  // namespace Eigen::internal

namespace Eigen {
BREAKWATER_KERNEL class PartialPivLU<MatrixXd>;
}
