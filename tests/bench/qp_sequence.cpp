#include "qp_sequence.h"

#include <hdf5.h>
#include <hdf5_hl.h>

#include <array>
#include <memory>
#include <stdexcept>
#include <vector>

namespace breakwater {
namespace {

using RowMajor = QpModel::RowMajor;

class File {
 public:
  File(hid_t id, const std::string& name) : id_(id), name_(name) {
    if (id < 0) throw std::runtime_error(name + ": cannot be opened");
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  ~File() { H5Fclose(id_); }

  // As in NumPy: rows × columns. A vector is a column.
  void write(const char* dataset, const Eigen::MatrixXd& matrix) const {
    const RowMajor rows = matrix;
    const std::array<hsize_t, 2> size = {static_cast<hsize_t>(rows.rows()),
                                         static_cast<hsize_t>(rows.cols())};
    require(H5LTmake_dataset_double(id_, dataset, 2, size.data(), rows.data()), dataset);
  }

  Eigen::MatrixXd read(const char* dataset) const {
    std::array<hsize_t, 2> size{};
    int rank = 0;
    require(H5LTget_dataset_ndims(id_, dataset, &rank), dataset);
    require(rank == 2 ? 0 : -1, dataset);
    require(H5LTget_dataset_info(id_, dataset, size.data(), nullptr, nullptr), dataset);
    RowMajor rows(static_cast<Eigen::Index>(size[0]), static_cast<Eigen::Index>(size[1]));
    require(H5LTread_dataset_double(id_, dataset, rows.data()), dataset);
    return rows;
  }

 private:
  void require(int status, const char* dataset) const {
    if (status < 0) throw std::runtime_error(name_ + ": " + dataset + ": not as expected");
  }

  hid_t id_;
  std::string name_;
};

}  // namespace

QpInput QpSequence::input(std::size_t k) const {
  const auto p = parameters.col(static_cast<Eigen::Index>(k));
  QpInput input(model.H.rows(), model.Omega.rows());
  input.g = g0 + G * p;
  input.lower = lower0 + E * p;
  input.upper = upper0 + E * p;
  return input;
}

void write(const QpSequence& sequence, const std::string& name) {
  const File file(H5Fcreate(name.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), name);
  file.write("H", sequence.model.H);
  file.write("Omega", sequence.model.Omega);
  file.write("g0", sequence.g0);
  file.write("G", sequence.G);
  file.write("lower0", sequence.lower0);
  file.write("upper0", sequence.upper0);
  file.write("E", sequence.E);
  file.write("parameters", sequence.parameters.transpose());
  file.write("A", sequence.A);
  file.write("B", sequence.B);
  file.write("Q", sequence.Q);
  file.write("Q_last", sequence.Q_last);
  file.write("R", sequence.R);
  file.write("prediction_steps", Eigen::MatrixXd::Constant(1, 1, sequence.prediction_steps));
  file.write("rows", sequence.rows.cast<double>());
}

QpSequence read_qp_sequence(const std::string& name) {
  const File file(H5Fopen(name.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), name);
  QpSequence sequence;
  sequence.model = {file.read("H"), file.read("Omega")};
  sequence.g0 = file.read("g0");
  sequence.G = file.read("G");
  sequence.lower0 = file.read("lower0");
  sequence.upper0 = file.read("upper0");
  sequence.E = file.read("E");
  sequence.parameters = file.read("parameters").transpose();
  sequence.A = file.read("A");
  sequence.B = file.read("B");
  sequence.Q = file.read("Q");
  sequence.Q_last = file.read("Q_last");
  sequence.R = file.read("R");
  sequence.prediction_steps = static_cast<int>(file.read("prediction_steps")(0, 0));
  sequence.rows = file.read("rows").cast<int>();

  Horizon horizon;
  horizon.A = sequence.A;
  horizon.B = sequence.B;
  horizon.prediction_steps = sequence.prediction_steps;
  horizon.control_steps = static_cast<int>(sequence.model.H.rows() / sequence.B.cols());
  horizon.Q = sequence.Q;
  horizon.Q_last = sequence.Q_last;
  horizon.R = sequence.R;
  horizon.S = Eigen::MatrixXd::Zero(sequence.B.cols(), sequence.B.cols());
  for (Eigen::Index i = 0; i < sequence.rows.rows(); ++i) {
    const auto row = sequence.rows.row(i);
    horizon.rows.push_back({static_cast<Horizon::RowKind>(row(0)), row(1), row(2)});
  }
  sequence.model.horizon = horizon;
  return sequence;
}

}  // namespace breakwater
