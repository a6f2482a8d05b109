#include <breakwater/linear/horizon.h>

#include <algorithm>

#include <breakwater/linear/small_products.h>
#include <breakwater/math/refuse_unless.h>

namespace breakwater {
namespace {

void check(const Horizon& horizon) {
  const Eigen::Index n = horizon.A.rows();
  const Eigen::Index m = horizon.B.cols();
  const auto is_square = [](const Eigen::MatrixXd& matrix, Eigen::Index size) {
    return matrix.rows() == size && matrix.cols() == size;
  };
  refuse_unless(n != 0 && m != 0 && is_square(horizon.A, n) && horizon.B.rows() == n &&
                    is_square(horizon.Q, n) && is_square(horizon.Q_last, n) &&
                    is_square(horizon.R, m) && is_square(horizon.S, m),
                "horizon: the matrices' shapes do not fit");
  refuse_unless(horizon.control_steps >= 1 && horizon.control_steps <= horizon.prediction_steps,
                "horizon: needs 1 <= control steps <= prediction steps");
  for (const Horizon::Row& row : horizon.rows) {
    const bool is_state = row.kind == Horizon::RowKind::state;
    const int first = is_state ? 1 : 0;
    const int last = is_state ? horizon.prediction_steps : horizon.control_steps - 1;
    refuse_unless(row.step >= first && row.step <= last && row.component >= 0 &&
                      row.component < (is_state ? n : m),
                  "horizon: a row has a step or component that does not exist");
  }
}

// Sweeps for n states and one input.
template <int n>
class Sweeps final : public HorizonSweeps {
 public:
  explicit Sweeps(const Horizon& horizon)
      : A_(horizon.A),
        A_transposed_(horizon.A.transpose()),
        A_squared_(horizon.A * horizon.A),
        A_squared_transposed_(A_squared_.transpose()),
        Q_(horizon.Q),
        Q_last_(horizon.Q_last),
        B_(horizon.B),
        AB_(Eigen::MatrixXd(horizon.A * horizon.B)),
        R_(horizon.R(0, 0)),
        S_(horizon.S(0, 0)),
        prediction_steps_(horizon.prediction_steps),
        control_steps_(horizon.control_steps),
        changes_(static_cast<std::size_t>(control_steps_)),
        inputs_(static_cast<std::size_t>(prediction_steps_)),
        states_(static_cast<std::size_t>(prediction_steps_), State::Zero()),
        change_forces_(changes_),
        input_forces_(inputs_),
        state_forces_(states_) {
    for (const Horizon::Row& row : horizon.rows) {
      const auto step = static_cast<std::size_t>(row.step);
      switch (row.kind) {
        case Horizon::RowKind::change:
          add_row(changes_[step], change_forces_[step]);
          break;
        case Horizon::RowKind::input:
          add_row(inputs_[step], input_forces_[step]);
          break;
        case Horizon::RowKind::state:
          add_row(states_[step - 1](row.component), state_forces_[step - 1](row.component));
          break;
      }
    }
  }

  void rows(const Eigen::VectorXd& changes, Eigen::VectorXd& values) override {
    roll_out(changes.data());
    for (std::size_t i = 0; i < values_.size(); ++i) {
      values(static_cast<Eigen::Index>(i)) = *values_[i];
    }
  }

  void gradient(const Eigen::VectorXd& changes, const Eigen::VectorXd& mu,
                Eigen::VectorXd& gradient) override {
    roll_out(changes.data());
    weigh(states_.front().data());
    for (std::size_t i = 0; i < changes_.size(); ++i) {
      change_forces_[i] = R_ * changes_[i];
      input_forces_[i] = S_ != 0.0 ? S_ * inputs_[i] : 0.0;
    }
    for (std::size_t i = 0; i < forces_.size(); ++i) {
      *forces_[i] += mu(static_cast<Eigen::Index>(i));
    }
    sweep_back(gradient.data());
  }

  void free_response(const Eigen::Ref<const Eigen::VectorXd>& x,
                     const Eigen::Ref<const Eigen::VectorXd>& u, Eigen::VectorXd& states) override {
    const State push = B_ * u(0);
    State now = x;
    for (int i = 0; i < prediction_steps_; ++i) {
      now = A_ * now + push;
      states.segment<n>(n * i) = now;
    }
  }

  void slope(const Eigen::VectorXd& errors, const Eigen::Ref<const Eigen::VectorXd>& u,
             Eigen::VectorXd& g) override {
    weigh(errors.data());
    std::fill(change_forces_.begin(), change_forces_.end(), 0.0);
    std::fill_n(input_forces_.begin(), control_steps_, S_ * u(0));
    sweep_back(g.data());
  }

 private:
  using State = Eigen::Matrix<double, n, 1>;

  struct Square {
    double M[n * n];

    explicit Square(const Eigen::MatrixXd& matrix) { std::copy_n(matrix.data(), n * n, M); }
    State operator*(const State& state) const {
      State product;
      multiply<n>(M, state.data(), product.data());
      return product;
    }
    Eigen::MatrixXd transpose() const {
      return Eigen::Map<const Eigen::MatrixXd>(M, n, n).transpose();
    }
  };

  void add_row(double& value, double& force) {
    values_.push_back(&value);
    forces_.push_back(&force);
  }

  // Computes changes_, inputs_ and states_ from x_0 = 0. It takes two steps at a time, x_{i+2} = A²
  // x_i + A B u_i + B u_{i+1}: this halves the chain of dependent operations.
  void roll_out(const double* changes) {
    std::copy_n(changes, control_steps_, changes_.begin());
    double input = 0.0;
    for (int i = 0; i < prediction_steps_; ++i) {
      if (i < control_steps_) input += changes[i];
      inputs_[i] = input;
    }
    State x = State::Zero();
    int i = 0;
    for (; i + 2 <= prediction_steps_; i += 2) {
      const State push = AB_ * inputs_[i] + B_ * inputs_[i + 1];
      states_[i] = A_ * x + B_ * inputs_[i];
      states_[i + 1] = x = A_squared_ * x + push;
    }
    if (i < prediction_steps_) states_[i] = A_ * x + B_ * inputs_[i];
  }

  // state_forces_ = Q̅ states.
  void weigh(const double* states) {
    for (int i = 0; i + 1 < prediction_steps_; ++i, states += n) {
      multiply<n>(Q_.M, states, state_forces_[i].data());
    }
    multiply<n>(Q_last_.M, states, state_forces_.back().data());
  }

  // The gradient with respect to ΔU, from those with respect to changes, inputs and states (the
  // forces f). The adjoint is p_i = f_i + Aᵀ p_{i+1}, two steps at a time as above. Bᵀ p_{i+1} acts
  // on u_i, and u_i is the sum of all changes up to i. p_{i+1} overwrites the force f_i, which is
  // not needed any more.
  void sweep_back(double* gradient) {
    State* const adjoint = state_forces_.data();
    int i = prediction_steps_ - 1;
    State p = adjoint[i];  // p_{i+1} of the last step
    for (; i >= 2; i -= 2) {
      const State one = adjoint[i - 1];
      const State carried = adjoint[i - 2] + A_transposed_ * one;
      adjoint[i] = p;
      adjoint[i - 1] = one + A_transposed_ * p;
      p = A_squared_transposed_ * p + carried;
    }
    adjoint[i] = p;
    if (i == 1) adjoint[0] = adjoint[0] + A_transposed_ * p;

    double sum = 0.0;
    for (i = prediction_steps_ - 1; i >= 0; --i) {
      sum += dot<n>(B_.data(), adjoint[i].data());
      if (i >= control_steps_) continue;
      sum += input_forces_[i];
      gradient[i] = change_forces_[i] + sum;
    }
  }

  Square A_;
  Square A_transposed_;
  Square A_squared_;
  Square A_squared_transposed_;
  Square Q_;
  Square Q_last_;
  State B_;
  State AB_;
  double R_;
  double S_;
  int prediction_steps_;
  int control_steps_;

  std::vector<double> changes_;
  std::vector<double> inputs_;  // for every predicted step
  std::vector<State> states_;
  std::vector<double> change_forces_;
  std::vector<double> input_forces_;
  std::vector<State> state_forces_;
  std::vector<const double*> values_;  // the value of each row, in one of the above
  std::vector<double*> forces_;
};

// For up to n states.
template <int n>
std::unique_ptr<HorizonSweeps> sweeps_up_to(const Horizon& horizon) {
  if (horizon.A.rows() == n) return std::make_unique<Sweeps<n>>(horizon);
  if constexpr (n > 1) return sweeps_up_to<n - 1>(horizon);
  return nullptr;
}

}  // namespace

std::unique_ptr<HorizonSweeps> make_horizon_sweeps(const Horizon& horizon) {
  check(horizon);
  return horizon.B.cols() == 1 ? sweeps_up_to<4>(horizon) : nullptr;
}

}  // namespace breakwater
