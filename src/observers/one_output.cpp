#include <breakwater/observers/one_output.h>

namespace breakwater::one_output {
namespace {

/// Σ term(i), summed in pairs for speed.
template <int N, typename Term>
double sum(const Term& term) {
  double terms[N];
  for (int i = 0; i < N; ++i) terms[i] = term(i);
  for (int width = 1; width < N; width *= 2) {
    for (int i = 0; i + width < N; i += 2 * width) terms[i] += terms[i + width];
  }
  return terms[0];
}

/// The sum of `count` terms with a distance of `stride`, by halves. This and the two functions
/// below keep the order of Eigen's products of fixed size, and so the bits of earlier runs.
template <int count, int stride>
double halves(const double* terms) {
  if constexpr (count == 1) {
    return terms[0];
  } else {
    constexpr int half = count / 2;
    return halves<half, stride>(terms) + halves<count - half, stride>(terms + half * stride);
  }
}

template <int N>
double output(const double* c, const double* __restrict x) {
  double terms[N];
  for (int i = 0; i < N; ++i) terms[i] = c[i] * x[i];
  const double pairs = halves<N / 2, 2>(terms) + halves<N / 2, 2>(terms + 1);
  return N % 2 == 0 ? pairs : pairs + terms[N - 1];
}

template <int N>
void predict(const double* A, const double* b, const double* Q, double u, double* __restrict x,
             double* __restrict P) {
  double Ax[N];
  for (int i = 0; i < N; ++i) {
    Ax[i] = A[i] * x[0];
    for (int k = 1; k < N; ++k) Ax[i] += A[i + k * N] * x[k];
  }
  if (N % 2 != 0) {
    double last[N];
    for (int k = 0; k < N; ++k) last[k] = A[N - 1 + k * N] * x[k];
    Ax[N - 1] = halves<N, 1>(last);
  }
  for (int i = 0; i < N; ++i) x[i] = Ax[i] + b[i] * u;

  double AP[N][N];
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j < N; ++j) {
      AP[i][j] = sum<N>([&](int k) { return A[i + k * N] * P[k + j * N]; });
    }
  }
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j <= i; ++j) {
      P[i + j * N] = P[j + i * N] =
          Q[i + j * N] + sum<N>([&](int k) { return AP[i][k] * A[j + k * N]; });
    }
  }
}

template <int N>
void times(const double* __restrict P, const double* c, bool is_first, double* __restrict result) {
  for (int i = 0; i < N; ++i) {
    result[i] = is_first ? P[i] : sum<N>([&](int k) { return P[i + k * N] * c[k]; });
  }
}

template <int N>
double measure(const double* __restrict P, const double* __restrict x, const double* c,
               bool is_first, double* __restrict h, double* __restrict variance) {
  times<N>(P, c, is_first, h);
  *variance = is_first ? h[0] : sum<N>([&](int k) { return h[k] * c[k]; });
  return output<N>(c, x);
}

// Joseph's form is
//     (I − K cᵀ) P (I − K cᵀ)ᵀ + K R Kᵀ = M + w Kᵀ + K wᵀ   with   M = P − K hᵀ,
//     w = (K R − M c)/2.
template <int N>
void correct(const double* __restrict h, const double* c, bool is_first, double e, double R,
             double D_inverse, double inflation, double* __restrict gain, double* __restrict x,
             double* __restrict P) {
  double K[N], M[N * N], w[N];
  for (int i = 0; i < N; ++i) {
    gain[i] = K[i] = h[i] * D_inverse;
    x[i] += K[i] * e;
  }
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j <= i; ++j) M[i + j * N] = M[j + i * N] = P[i + j * N] - K[i] * h[j];
  }
  times<N>(M, c, is_first, w);
  for (int i = 0; i < N; ++i) w[i] = 0.5 * (K[i] * R - w[i]);
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j <= i; ++j) {
      P[i + j * N] = P[j + i * N] = (M[i + j * N] + (w[i] * K[j] + w[j] * K[i])) * inflation;
    }
  }
}

template <int N>
constexpr Kernel kKernel = {predict<N>, output<N>, measure<N>, correct<N>};
constexpr const Kernel* kKernels[] = {&kKernel<2>, &kKernel<3>, &kKernel<4>, &kKernel<5>,
                                      &kKernel<6>};

}  // namespace

const Kernel* kernel(Eigen::Index states) {
  return states >= 2 && states <= 6 ? kKernels[states - 2] : nullptr;
}

}  // namespace breakwater::one_output
