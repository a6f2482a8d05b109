#include <breakwater/linear/horizon.h>

#include <stdexcept>

namespace breakwater {
namespace {

void check(const Horizon& horizon) {
  const Eigen::Index n = horizon.A.rows();
  const Eigen::Index m = horizon.B.cols();
  const auto is_square = [](const Eigen::MatrixXd& matrix, Eigen::Index size) {
    return matrix.rows() == size && matrix.cols() == size;
  };
  if (n == 0 || m == 0 || !is_square(horizon.A, n) || horizon.B.rows() != n ||
      !is_square(horizon.Q, n) || !is_square(horizon.Q_last, n) || !is_square(horizon.R, m) ||
      !is_square(horizon.S, m)) {
    throw std::invalid_argument("horizon: the matrices' shapes do not fit");
  }
  if (horizon.control_steps < 1 || horizon.control_steps > horizon.prediction_steps) {
    throw std::invalid_argument("horizon: needs 1 <= control steps <= prediction steps");
  }
  for (const Horizon::Row& row : horizon.rows) {
    const bool is_state = row.kind == Horizon::RowKind::state;
    const int first = is_state ? 1 : 0;
    const int last = is_state ? horizon.prediction_steps : horizon.control_steps - 1;
    if (row.step < first || row.step > last || row.component < 0 ||
        row.component >= (is_state ? n : m)) {
      throw std::invalid_argument("horizon: a row has a step or component that does not exist");
    }
  }
}

// Sweeps for n states and m inputs.
template <int n, int m>
class Sweeps final : public HorizonSweeps {
 public:
  explicit Sweeps(const Horizon& horizon)
      : A_(horizon.A),
        B_(horizon.B),
        A_transposed_(horizon.A.transpose()),
        A_squared_(horizon.A * horizon.A),
        AB_(horizon.A * horizon.B),
        A_squared_transposed_(A_squared_.transpose()),
        Q_(horizon.Q),
        Q_last_(horizon.Q_last),
        R_(horizon.R),
        S_(horizon.S),
        has_S_(!horizon.S.isZero(0.0)),
        prediction_steps_(horizon.prediction_steps),
        control_steps_(horizon.control_steps),
        changes_(Inputs::Zero(B_.cols(), control_steps_)),
        inputs_(Inputs::Zero(B_.cols(), prediction_steps_)),
        states_(States::Zero(A_.rows(), prediction_steps_)),
        change_forces_(changes_),
        input_forces_(inputs_),
        state_forces_(states_) {
    for (const Horizon::Row& row : horizon.rows) {
      switch (row.kind) {
        case Horizon::RowKind::change:
          add_row(changes_, change_forces_, row.component, row.step);
          break;
        case Horizon::RowKind::input:
          add_row(inputs_, input_forces_, row.component, row.step);
          break;
        case Horizon::RowKind::state:
          add_row(states_, state_forces_, row.component, row.step - 1);
          break;
      }
    }
  }

  void rows(const Eigen::VectorXd& changes, Eigen::VectorXd& values) override {
    roll_out(changes);
    for (std::size_t i = 0; i < values_.size(); ++i) {
      values(static_cast<Eigen::Index>(i)) = *values_[i];
    }
  }

  void gradient(const Eigen::VectorXd& changes, const Eigen::VectorXd& mu,
                Eigen::VectorXd& gradient) override {
    roll_out(changes);
    weigh(states_);
    change_forces_.noalias() = R_ * changes_;
    if (has_S_) {
      input_forces_.leftCols(control_steps_).noalias() = S_ * inputs_.leftCols(control_steps_);
    } else {
      input_forces_.leftCols(control_steps_).setZero();
    }
    for (std::size_t i = 0; i < forces_.size(); ++i) {
      *forces_[i] += mu(static_cast<Eigen::Index>(i));
    }
    sweep_back(gradient);
  }

  void free_response(const Eigen::Ref<const Eigen::VectorXd>& x,
                     const Eigen::Ref<const Eigen::VectorXd>& u, Eigen::VectorXd& states) override {
    Eigen::Map<States> all(states.data(), A_.rows(), prediction_steps_);
    const State push = B_ * Input(u);
    State now = x;
    for (int i = 0; i < prediction_steps_; ++i) {
      const State next = A_ * now + push;
      all.col(i) = now = next;
    }
  }

  void slope(const Eigen::VectorXd& errors, const Eigen::Ref<const Eigen::VectorXd>& u,
             Eigen::VectorXd& g) override {
    weigh(Eigen::Map<const States>(errors.data(), A_.rows(), prediction_steps_));
    change_forces_.setZero();
    input_forces_.leftCols(control_steps_).colwise() = Input(S_ * Input(u));
    sweep_back(g);
  }

 private:
  using State = Eigen::Matrix<double, n, 1>;
  using Input = Eigen::Matrix<double, m, 1>;
  using States = Eigen::Matrix<double, n, Eigen::Dynamic>;
  using Inputs = Eigen::Matrix<double, m, Eigen::Dynamic>;

  template <typename Steps>
  void add_row(Steps& values, Steps& forces, Eigen::Index component, int column) {
    values_.push_back(&values(component, column));
    forces_.push_back(&forces(component, column));
  }

  // Computes changes_, inputs_ and states_ from x_0 = 0. It takes two steps at a time, x_{i+2} = A²
  // x_i + A B u_i + B u_{i+1}: this halves the chain of dependent operations.
  void roll_out(const Eigen::VectorXd& changes) {
    changes_ = Eigen::Map<const Inputs>(changes.data(), B_.cols(), control_steps_);
    Input input = Input::Zero(B_.cols());
    for (int i = 0; i < prediction_steps_; ++i) {
      if (i < control_steps_) input += changes_.col(i);
      inputs_.col(i) = input;
    }
    State x = State::Zero(A_.rows());
    int i = 0;
    for (; i + 2 <= prediction_steps_; i += 2) {
      const Input first = inputs_.col(i);
      const Input second = inputs_.col(i + 1);
      const State push = AB_ * first + B_ * second;
      states_.col(i) = A_ * x + B_ * first;
      const State after = A_squared_ * x + push;
      states_.col(i + 1) = x = after;
    }
    if (i < prediction_steps_) states_.col(i) = A_ * x + B_ * inputs_.col(i);
  }

  // state_forces_ = Q̅ states.
  template <typename Steps>
  void weigh(const Steps& states) {
    for (int i = 0; i + 1 < prediction_steps_; ++i) {
      state_forces_.col(i).noalias() = Q_ * states.col(i);
    }
    state_forces_.col(prediction_steps_ - 1).noalias() =
        Q_last_ * states.col(prediction_steps_ - 1);
  }

  // The gradient with respect to ΔU, from those with respect to changes, inputs and states (the
  // forces f). The adjoint is p_i = f_i + Aᵀ p_{i+1}, two steps at a time as above. Bᵀ p_{i+1} acts
  // on u_i, and u_i is the sum of all changes up to i.
  void sweep_back(Eigen::VectorXd& gradient) {
    const int N = prediction_steps_;
    Eigen::Map<Inputs> result(gradient.data(), B_.cols(), control_steps_);
    State p = state_forces_.col(N - 1);  // p_{i+1} of the step i = N − 1
    int i = N - 1;
    for (; i >= 2; i -= 2) {
      const State one = state_forces_.col(i - 1);
      const State carried = state_forces_.col(i - 2) + A_transposed_ * one;
      adjoint(i) = p;
      adjoint(i - 1) = one + A_transposed_ * p;
      const State before = A_squared_transposed_ * p + carried;
      p = before;
    }
    adjoint(i) = p;
    if (i == 1) adjoint(0) = state_forces_.col(0) + A_transposed_ * p;

    Input sum = Input::Zero(B_.cols());
    for (i = N - 1; i >= 0; --i) {
      sum += B_.transpose() * adjoint(i);
      if (i >= control_steps_) continue;
      sum += input_forces_.col(i);
      result.col(i) = change_forces_.col(i) + sum;
    }
  }
  // p_{i+1} overwrites the force f_i, which is not needed any more.
  auto adjoint(int i) { return state_forces_.col(i); }

  Eigen::Matrix<double, n, n> A_;
  Eigen::Matrix<double, n, m> B_;
  Eigen::Matrix<double, n, n> A_transposed_;
  Eigen::Matrix<double, n, n> A_squared_;
  Eigen::Matrix<double, n, m> AB_;
  Eigen::Matrix<double, n, n> A_squared_transposed_;
  Eigen::Matrix<double, n, n> Q_;
  Eigen::Matrix<double, n, n> Q_last_;
  Eigen::Matrix<double, m, m> R_;
  Eigen::Matrix<double, m, m> S_;
  bool has_S_;
  int prediction_steps_;
  int control_steps_;

  Inputs changes_;
  Inputs inputs_;  // for every predicted step
  States states_;
  Inputs change_forces_;
  Inputs input_forces_;
  States state_forces_;
  std::vector<const double*> values_;  // the value of each row, in one of the above
  std::vector<double*> forces_;
};

}  // namespace

std::unique_ptr<HorizonSweeps> make_horizon_sweeps(const Horizon& horizon) {
  check(horizon);
  if (horizon.B.cols() != 1) return nullptr;
  switch (horizon.A.rows()) {
    case 1:
      return std::make_unique<Sweeps<1, 1>>(horizon);
    case 2:
      return std::make_unique<Sweeps<2, 1>>(horizon);
    case 3:
      return std::make_unique<Sweeps<3, 1>>(horizon);
    case 4:
      return std::make_unique<Sweeps<4, 1>>(horizon);
    default:
      return nullptr;
  }
}

}  // namespace breakwater
