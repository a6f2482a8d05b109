#include <breakwater/control/prediction.h>

#include <algorithm>
#include <stdexcept>

namespace breakwater {

Prediction predict(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, int prediction_steps,
                   int control_steps) {
  const Eigen::Index n = A.rows();
  const Eigen::Index m = B.cols();
  if (n == 0 || m == 0 || A.cols() != n || B.rows() != n) {
    throw std::invalid_argument("prediction: A must be n×n and B n×m");
  }
  if (prediction_steps < 1 || control_steps < 1) {
    throw std::invalid_argument("prediction: the horizons must be at least 1 step");
  }
  if (control_steps > prediction_steps) {
    throw std::invalid_argument(
        "prediction: the control horizon must not be longer than the prediction horizon");
  }
  Prediction prediction{Eigen::MatrixXd(prediction_steps * n, n),
                        Eigen::MatrixXd(prediction_steps * n, m),
                        Eigen::MatrixXd::Zero(prediction_steps * n, control_steps * m)};
  Eigen::MatrixXd power = Eigen::MatrixXd::Identity(n, n);  // Aⁱ
  Eigen::MatrixXd response = Eigen::MatrixXd::Zero(n, m);   // S_i
  for (int i = 0; i < prediction_steps; ++i) {
    response += power * B;
    power = A * power;
    prediction.Psi.middleRows(i * n, n) = power;
    prediction.Gamma.middleRows(i * n, n) = response;
  }
  for (int i = 0; i < prediction_steps; ++i) {
    for (int j = 0; j <= std::min(i, control_steps - 1); ++j) {
      prediction.Theta.block(i * n, j * m, n, m) = prediction.Gamma.middleRows((i - j) * n, n);
    }
  }
  return prediction;
}

}  // namespace breakwater
