// The Python module ed3r._core: stepped missions, sweeps flown by Python policies, stored results. What users see is the
// package around it (engine/python/ed3r/).
//
// The interpreter lock is released while missions fly. Arrays of a fleet are views of its memory: read-only, valid for as
// long as they are held, overwritten by the next step.
#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <atomic>
#include <exception>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/agents/execution_policy.h"
#include "engine/core/check.h"
#include "engine/python/argument_words.h"
#include "engine/python/fleets.h"
#include "engine/python/networks.h"
#include "engine/python/results.h"
#include "engine/python/sweeps.h"
#include "engine/rfnn/features.h"
#include "engine/schedule/scheduler.h"
#include "engine/sweep/sweep_file.h"

namespace py = pybind11;

namespace ed3r::python {
namespace {

std::atomic<bool> interpreter_ends{false};

using Floats = py::array_t<float, py::array::c_style | py::array::forcecast>;
using Codes = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>;
using Marks = py::array_t<std::uint8_t, py::array::c_style | py::array::forcecast>;

// `values` as rows x width, or as one value a row with width 0. No copy: the array keeps `owner` alive.
template <class Value>
py::array View(const std::vector<Value>& values, py::ssize_t width, const char* type,
               const py::handle& owner) {
  const auto rows = static_cast<py::ssize_t>(values.size()) / (width == 0 ? 1 : width);
  const auto size = static_cast<py::ssize_t>(sizeof(Value));
  std::vector<py::ssize_t> shape{rows}, strides{size * (width == 0 ? 1 : width)};
  if (width > 0) shape.push_back(width), strides.push_back(size);
  py::array array(py::dtype(type), shape, strides, values.data(), owner);
  array.attr("flags").attr("writeable") = false;
  return array;
}

py::dict Views(const schedule::FleetColumns& c, const py::handle& owner) {
  py::dict views;
  views["controller"] = View(c.controller, rfnn::kRcStates, "f4", owner);
  views["robot"] = View(c.robot, rfnn::kRobotStates, "f4", owner);
  views["ranges"] = View(c.ranges, 3, "f4", owner);
  const auto add = [&](const char* name, const auto& values, const char* type) {
    views[name] = View(values, 0, type, owner);
  };
  add("hovers", c.hovers, "?"), add("terminated", c.terminated, "?"), add("truncated", c.truncated, "?");
  add("begun", c.begun, "?"), add("paid", c.paid, "?");
  add("mission", c.mission, "i8"), add("timestep", c.timestep, "i8");
  add("outcome", c.outcome, "i8"), add("execution", c.execution, "i8"), add("reward", c.reward, "f8");
  add("scs", c.scs, "f8"), add("duration_s", c.duration_s, "f8"), add("movement_j", c.movement_j, "f8");
  add("sensing_j", c.sensing_j, "f8"), add("computation_j", c.computation_j, "f8");
  add("transmission_j", c.transmission_j, "f8"), add("total_j", c.total_j, "f8");
  add("battery_j", c.battery_j, "f8");
  return views;
}

// The values of an array of rows x width (width 0: rows), whatever its type.
template <class Array>
auto Values(const Array& array, std::size_t rows, std::size_t width, const char* name) {
  const bool fits = width == 0 ? array.ndim() == 1 && array.shape(0) == static_cast<py::ssize_t>(rows)
                               : array.ndim() == 2 && array.shape(0) == static_cast<py::ssize_t>(rows) &&
                                     array.shape(1) == static_cast<py::ssize_t>(width);
  if (!fits)
    throw UserError(std::string(name) + ": has another shape; allowed: (" + std::to_string(rows) +
                    (width == 0 ? ",)" : ", " + std::to_string(width) + ")"));
  return std::span(array.data(), static_cast<std::size_t>(array.size()));
}

void BindFleet(py::module_& module) {
  py::class_<FleetHandle, std::shared_ptr<FleetHandle>>(module, "Fleet")
      .def_property_readonly("rows", [](const FleetHandle& h) { return h.fleet->rows(); })
      .def_property_readonly("arm", [](const FleetHandle& h) { return h.arm; })
      .def_property_readonly("stopped",
                             [](const FleetHandle& h) { return h.stop != nullptr && h.stop->load(); })
      .def_property_readonly("largest_command", [](const FleetHandle& h) { return h.LargestCommand(); })
      .def(
          "views",
          [](const py::object& self, bool final) {
            const schedule::Fleet& fleet = *self.cast<const FleetHandle&>().fleet;
            return Views(final ? fleet.Final() : fleet.Now(), self);
          },
          py::arg("final") = false)
      .def(
          "reset",
          [](FleetHandle& h, const std::optional<Marks>& mask, std::optional<std::uint64_t> seed) {
            std::span<const std::uint8_t> marks;
            if (mask) marks = Values(*mask, h.fleet->rows(), 0, "reset_mask");
            const py::gil_scoped_release release;
            h.Reset(marks, seed);
          },
          py::arg("mask") = py::none(), py::arg("seed") = py::none())
      .def("reset_each",
           [](FleetHandle& h, const std::optional<Marks>& mask,
              const std::vector<std::optional<std::uint64_t>>& seeds) {
             std::span<const std::uint8_t> marks;
             if (mask) marks = Values(*mask, h.fleet->rows(), 0, "reset_mask");
             const py::gil_scoped_release release;
             h.ResetEach(marks, seeds);
           })
      .def("move",
           [](FleetHandle& h, const Floats& commands) {
             const auto values = Values(commands, h.fleet->rows(), schedule::kCommandValues, "commands");
             const py::gil_scoped_release release;
             h.fleet->Move(values);
           })
      .def("detect", [](FleetHandle& h, const Codes& executions) {
        const auto values = Values(executions, h.fleet->rows(), 0, "executions");
        const py::gil_scoped_release release;
        h.fleet->Detect(values);
      });
  module.def(
      "make_fleet",
      [](const SweepRequest& request, const std::string& arm, std::size_t rows, int threads,
         const std::string& autoreset) {
        const py::gil_scoped_release release;
        return MakeFleet(request, arm, rows, threads, autoreset);
      },
      py::arg("request"), py::arg("arm"), py::arg("rows"), py::arg("threads"), py::arg("autoreset"));
}

py::object Column(const ResultColumn& column) {
  if (column.is_real)
    return py::array_t<double>(static_cast<py::ssize_t>(column.reals.size()), column.reals.data());
  return py::array_t<std::int64_t>(static_cast<py::ssize_t>(column.integers.size()), column.integers.data());
}

py::dict Table(const std::vector<ResultColumn>& columns) {
  py::dict table;
  for (const ResultColumn& column : columns) table[py::str(column.name)] = Column(column);
  return table;
}

void BindResults(py::module_& module) {
  py::class_<RunReader>(module, "RunReader")
      .def(py::init<const std::string&>(), py::call_guard<py::gil_scoped_release>())
      .def_property_readonly("name", &RunReader::Name)
      .def_property_readonly("notes", &RunReader::Notes)
      .def("arms", &RunReader::Arms)
      .def("missions", [](RunReader& reader, const std::string& arm) { return Table(reader.Missions(arm)); })
      .def("steps", [](RunReader& reader, const std::string& arm) { return Table(reader.Timesteps(arm)); })
      .def("report_json", &RunReader::ReportText, py::call_guard<py::gil_scoped_release>())
      .def("digest", &RunReader::Digest, py::call_guard<py::gil_scoped_release>());
  py::class_<ArmCount>(module, "ArmCount")
      .def_readonly("stage", &ArmCount::stage)
      .def_readonly("arm", &ArmCount::arm)
      .def_readonly("planned", &ArmCount::planned)
      .def_readonly("done", &ArmCount::done)
      .def_readonly("failed", &ArmCount::failed);
  module.def("code_names", &CodeNames);
}

rfnn::OnnxTensor Tensor(const Floats& array) {
  rfnn::OnnxTensor tensor;
  for (py::ssize_t axis = 0; axis < array.ndim(); ++axis) tensor.dims.push_back(array.shape(axis));
  tensor.values.assign(array.data(), array.data() + array.size());
  return tensor;
}

void BindNetworks(py::module_& module) {
  module.def("network_bytes",
             [](const std::string& name, const std::string& agent, const std::vector<Floats>& weights,
                const std::vector<Floats>& biases, std::vector<float> mean, std::vector<float> inverse_sd) {
               rfnn::DenseChain chain{std::move(mean), std::move(inverse_sd), {}, {}};
               for (const Floats& layer : weights) chain.weights.push_back(Tensor(layer));
               for (const Floats& layer : biases) chain.biases.push_back(Tensor(layer));
               return py::bytes(NetworkBytes(chain, name, agent));
             });
}

void BindSweeps(py::module_& module) {
  py::class_<SweepRequest>(module, "SweepRequest")
      .def(
          py::init<std::string, std::vector<std::string>, std::optional<std::uint64_t>, std::optional<int>>(),
          py::arg("file"), py::arg("settings"), py::arg("seed"), py::arg("missions"));
  module.def("sweep_outline", [](const SweepRequest& request) {
    const sweep::SweepPlan plan = LoadRequest(request);
    return std::pair(plan.name, OutsideArms(plan));
  });
  module.def("end_flights", [] { interpreter_ends = true; });
  module.def(
      "fly", [](const SweepRequest& request, const std::string& out, const std::string& cache,
                const std::string& identity, std::size_t rows, int threads, const py::function& drive) {
        const DriveFn call = [&](const std::shared_ptr<FleetHandle>& fleet) {
          const py::gil_scoped_acquire acquire;
          drive(fleet);
        };
        // Python's handlers run on its main thread alone; on another this does nothing.
        const auto heed = [] {
          if (interpreter_ends) throw std::runtime_error("the interpreter ends; what is stored is kept");
          const py::gil_scoped_acquire acquire;
          if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        };
        const py::gil_scoped_release release;
        const FlightCount count = FlyWithPolicy(request, {out, cache, identity, rows, threads}, call, heed);
        return std::pair(count.stored, count.failed);
      });
}

}  // namespace
}  // namespace ed3r::python

PYBIND11_MODULE(_core, module) {
  module.doc() = "The engine behind the package ed3r.";
  static const py::exception<ed3r::UserError> user_error(module, "UserError", PyExc_ValueError);
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const ed3r::UserError& error) {
      PyErr_SetString(user_error.ptr(), ed3r::python::InPythonWords(error.what()).c_str());
    }
  });
  py::register_exception<ed3r::InternalError>(module, "InternalError", PyExc_RuntimeError);
  ed3r::python::BindNetworks(module);
  ed3r::python::BindSweeps(module);
  ed3r::python::BindFleet(module);
  ed3r::python::BindResults(module);
  module.attr("most_envs") = ed3r::python::kMostRows;
  module.attr("most_missions") = ed3r::sweep::kMaxMissions;
  module.attr("most_threads") = ed3r::schedule::kMostThreads;
  module.attr("executions") = ed3r::agents::kExecutions.size();
  module.attr("controller_features") = py::cast(std::vector<std::string>(
      ed3r::rfnn::kRcFeatures.begin(), ed3r::rfnn::kRcFeatures.begin() + ed3r::rfnn::kRcStates));
  module.attr("robot_features") = py::cast(std::vector<std::string>(
      ed3r::rfnn::kRobotFeatures.begin(), ed3r::rfnn::kRobotFeatures.begin() + ed3r::rfnn::kRobotStates));
}
