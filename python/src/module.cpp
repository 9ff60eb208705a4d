// The module poissontiles._core makes the samplers of the core available to the Python code of the package.

#include "own_threads.hpp"
#include "watcher.hpp"

#include "core/base/check.hpp"
#include "core/base/rect.hpp"
#include "core/sampling/domain/domain_sampler.hpp"
#include "core/sampling/obstacles.hpp"
#include "core/sampling/set_digest.hpp"
#include "core/sampling/tile_sampler.hpp"
#include "core/surface/surface_sampler.hpp"

#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

namespace nb = nanobind;

namespace thicket::python {

namespace doc {

inline constexpr const char *cancel =
		R"(Cancels calls from any thread: pass this object to a call, and call its method `cancel` on another thread.

The object stays cancelled: a later call that receives it ends immediately.)";

inline constexpr const char *cancel_cancel =
		R"(Ends the calls that use this object within a few milliseconds: they raise Cancelled. Any thread may call this method.)";

inline constexpr const char *cancel_cancelled = R"(True if cancel() was called.)";

} // namespace doc

namespace {

template <typename Number, nb::ssize_t axes>
using Array = std::conditional_t<axes == 1, nb::ndarray<nb::numpy, const Number, nb::ndim<1>>,
		nb::ndarray<nb::numpy, const Number, nb::shape<-1, axes>>>;

/// Moves a list of numbers or vectors of numbers into an array, which owns it.
template <typename Number, nb::ssize_t axes, typename Value>
Array<Number, axes> array_of(std::vector<Value> &&list) {
	static_assert(sizeof(Value) == axes * sizeof(Number));
	auto own = std::make_unique<std::vector<Value>>(std::move(list));
	static const Value dummy{}; // An array needs an address, even without values.
	const auto *first = reinterpret_cast<const Number *>(own->empty() ? &dummy : own->data());
	const std::size_t count = own->size();
	const nb::capsule owner(own.get(), [](void *list) noexcept { delete static_cast<std::vector<Value> *>(list); });
	own.release();
	if constexpr (axes == 1) {
		return Array<Number, axes>(first, {count}, owner);
	} else {
		return Array<Number, axes>(first, {count, static_cast<std::size_t>(axes)}, owner);
	}
}

/// Returns one member of all points.
template <typename Point, typename Value>
std::vector<Value> column(const std::vector<Point> &points, Value Point::*member) {
	std::vector<Value> values;
	values.reserve(points.size());
	for (const Point &point : points) {
		values.push_back(point.*member);
	}
	return values;
}

[[noreturn]] void raise_value_error(const std::string &message) {
	PyErr_SetString(PyExc_ValueError, message.c_str());
	throw nb::python_error();
}

void require(const Status &status) {
	if (!status.ok()) {
		raise_value_error(describe(status));
	}
}

/// Lends the sampler that this thread used before, whose memory is already allocated. Lends a new
/// one if there is none or a call is using it.
class Lease {
public:
	Lease() : sampler_(std::move(spare())) {
		if (!sampler_) {
			sampler_ = std::make_unique<TileSampler>();
		}
	}
	~Lease() { spare() = std::move(sampler_); }
	Lease(const Lease &) = delete;
	Lease &operator=(const Lease &) = delete;

	TileSampler &sampler() { return *sampler_; }

private:
	static std::unique_ptr<TileSampler> &spare() {
		thread_local std::unique_ptr<TileSampler> own;
		return own;
	}

	std::unique_ptr<TileSampler> sampler_;
};

constexpr int max_threads = 256;

/// `levels` and `layer` are integers.
PointSet set_of(double radius, std::uint64_t seed, double levels, double layer) {
	require(first_failure(check_range("levels", levels, 1, max_levels),
			check_range("layer", layer, 0, std::numeric_limits<std::uint16_t>::max())));
	return {.seed = seed,
			.radius = radius,
			.levels = static_cast<std::uint32_t>(levels),
			.layer = static_cast<std::uint16_t>(layer)};
}

using Ids = Array<std::uint64_t, 1>;
using Integers = Array<std::uint32_t, 1>;

template <typename Number>
using Triples = nb::ndarray<const Number, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;

/// Converts rows of x, y and radius.
std::vector<Obstacle> disks_of(const Triples<double> &rows) {
	std::vector<Obstacle> disks;
	disks.reserve(rows.shape(0));
	for (std::size_t i = 0; i < rows.shape(0); ++i) {
		const double *row = rows.data() + 3 * i;
		disks.push_back({{row[0], row[1]}, row[2]});
	}
	return disks;
}

/// Returns the positions, IDs, ranks and levels of a set.
std::tuple<Array<double, 2>, Ids, Integers, Integers> sample(const std::array<double, 4> &rect, double radius,
		std::uint64_t seed, double levels, double layer, bool even, double threads,
		const std::optional<Triples<double>> &fixed, const std::array<std::int32_t, 2> &period, nb::object progress,
		const Cancel *cancel) {
	PointSet set = set_of(radius, seed, levels, layer);
	set.even_order = even;
	set.period = {period[0], period[1]};
	require(check_range("threads", threads, 0, max_threads));
	const std::vector<Obstacle> disks = fixed ? disks_of(*fixed) : std::vector<Obstacle>();
	Watcher watcher(std::move(progress), cancel);
	std::vector<SamplePoint> points;
	Status status;
	{
		const nb::gil_scoped_release unlocked;
		Lease lease;
		OwnThreads others(threads > 0 ? static_cast<std::size_t>(threads) - 1 : OwnThreads::spare());
		const Rect window{{rect[0], rect[1]}, {rect[2], rect[3]}};
		if (!fixed) {
			status = lease.sampler().sample(set, window, points, watcher.progress(), &others);
		}
		for (std::size_t i = 0; fixed && i < fill_margins.size(); ++i) {
			const Obstacles obstacles{disks, fill_margins[i]};
			status = lease.sampler().sample(set, window, points, watcher.progress(), &others, &obstacles);
			if (status.code != ErrorCode::margin_too_wide) {
				break;
			}
		}
	}
	watcher.finish(status, describe(status), points.size());
	return std::make_tuple(array_of<double, 2>(column(points, &SamplePoint::position)),
			array_of<std::uint64_t, 1>(column(points, &SamplePoint::id)),
			array_of<std::uint32_t, 1>(column(points, &SamplePoint::rank)),
			array_of<std::uint32_t, 1>(column(points, &SamplePoint::level)));
}

/// Returns the vertices to which each face refers, three per face.
std::vector<std::uint32_t> indices_of(const Triples<std::int64_t> &faces, std::size_t vertices) {
	const std::span<const std::int64_t> all(faces.data(), 3 * faces.shape(0));
	std::vector<std::uint32_t> indices;
	indices.reserve(all.size());
	for (const std::int64_t index : all) {
		if (index < 0 || static_cast<std::uint64_t>(index) >= vertices) {
			raise_value_error("faces must have indices of vertices, 0 to " +
					std::to_string(static_cast<std::int64_t>(vertices) - 1) + ", got " + std::to_string(index));
		}
		indices.push_back(static_cast<std::uint32_t>(index));
	}
	return indices;
}

/// Returns the positions, IDs, ranks, levels, normals and faces of a set.
std::tuple<Array<double, 3>, Ids, Integers, Integers, Array<double, 3>, Integers> sample_surface(
		const Triples<double> &vertices, const Triples<std::int64_t> &faces, double radius, std::uint64_t seed,
		const std::optional<std::array<double, 6>> &window, double levels, double layer, nb::object progress,
		const Cancel *cancel) {
	const PointSet set = set_of(radius, seed, levels, layer);
	const auto *first = reinterpret_cast<const glm::dvec3 *>(vertices.data());
	std::vector<glm::dvec3> corners(first, first + vertices.shape(0));
	std::vector<std::uint32_t> indices = indices_of(faces, corners.size());
	Watcher watcher(std::move(progress), cancel);
	std::vector<SurfacePoint> points;
	Status status;
	{
		const nb::gil_scoped_release unlocked;
		std::shared_ptr<const Surface> surface;
		status = Surface::create(std::move(corners), std::move(indices), surface);
		if (status.ok()) {
			SurfaceSampler sampler;
			if (window) {
				const auto &[min_x, min_y, min_z, max_x, max_y, max_z] = *window;
				const Box3 box{{min_x, min_y, min_z}, {max_x, max_y, max_z}};
				status = sampler.sample(set, *surface, box, points, watcher.progress());
			} else {
				status = sampler.sample_all(set, *surface, points, watcher.progress());
			}
		}
	}
	watcher.finish(status, describe(status), points.size());
	return std::make_tuple(array_of<double, 3>(column(points, &SurfacePoint::position)),
			array_of<std::uint64_t, 1>(column(points, &SurfacePoint::id)),
			array_of<std::uint32_t, 1>(column(points, &SurfacePoint::rank)),
			array_of<std::uint32_t, 1>(column(points, &SurfacePoint::level)),
			array_of<double, 3>(column(points, &SurfacePoint::normal)),
			array_of<std::uint32_t, 1>(column(points, &SurfacePoint::triangle)));
}

constexpr std::array<std::pair<const char *, DomainMethod>, 4> methods{
		{{"naive", DomainMethod::naive}, {"hierarchical", DomainMethod::hierarchical},
				{"accumulator", DomainMethod::accumulator}, {"wavefront", DomainMethod::wavefront}}};

DomainMethod method_of(const std::string &name) {
	std::string names;
	for (const auto &[known, method] : methods) {
		if (name == known) {
			return method;
		}
		names += std::string(names.empty() ? "'" : ", '") + known + "'";
	}
	raise_value_error("method must be one of " + names + ", 'tiles', got '" + name + "'");
}

template <typename Real>
Array<Real, 2> sample_domain(const std::array<double, 2> &size, double radius, std::uint64_t seed,
		const std::string &method, bool toroidal, double cell_size, double darts_each, nb::object progress,
		const Cancel *cancel) {
	const DomainRequest request{.size = {size[0], size[1]},
			.radius = radius,
			.seed = seed,
			.method = method_of(method),
			.toroidal = toroidal,
			.cell_size = cell_size,
			.darts_each = darts_each};
	Watcher watcher(std::move(progress), cancel);
	std::vector<glm::vec<2, Real>> points;
	Status status;
	{
		const nb::gil_scoped_release unlocked;
		status = DomainSampler<Real>().sample(request, points, watcher.progress());
	}
	watcher.finish(status, describe(request, status), points.size());
	return array_of<Real, 2>(std::move(points));
}

template <typename Number>
using Numbers = nb::ndarray<const Number, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
template <typename Real>
using Pairs = nb::ndarray<const Real, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu>;

std::pair<std::uint64_t, std::uint64_t> digest_of_points(const Pairs<double> &positions,
		const Numbers<std::uint64_t> &ids, const Numbers<std::uint32_t> &ranks, const Numbers<std::uint32_t> &levels) {
	const nb::gil_scoped_release unlocked;
	std::vector<SamplePoint> points;
	points.reserve(positions.shape(0));
	for (std::size_t i = 0; i < positions.shape(0); ++i) {
		const double *position = positions.data() + 2 * i;
		points.push_back({{position[0], position[1]}, ids.data()[i], ranks.data()[i], levels.data()[i]});
	}
	const SetDigest digests = digest(std::span<const SamplePoint>(points));
	return {digests.points, digests.ranks};
}

template <typename Real>
std::uint64_t digest_of_domain(const Pairs<Real> &positions) {
	const auto *first = reinterpret_cast<const glm::vec<2, Real> *>(positions.data());
	const std::size_t count = positions.shape(0);
	const nb::gil_scoped_release unlocked;
	return digest(std::span<const glm::vec<2, Real>>(first, count));
}

} // namespace

} // namespace thicket::python

NB_MODULE(_core, module) {
	using namespace thicket::python;
	module.doc() = "The samplers of Thicket's core. Import poissontiles instead, which checks the types of arguments.";
	nb::class_<Cancel>(module, "Cancel", doc::cancel)
			.def(nb::init<>())
			.def("cancel", &Cancel::cancel, doc::cancel_cancel)
			.def_prop_ro("cancelled", &Cancel::cancelled, doc::cancel_cancelled);
	nb::exception<Cancelled>(module, "Cancelled", PyExc_RuntimeError).attr("__doc__") =
			"Raised when a Cancel has ended a call.";
	using nb::literals::operator""_a;
	module.def("sample", &sample, "rect"_a, "radius"_a, "seed"_a, "levels"_a, "layer"_a, "even"_a, "threads"_a,
			"fixed"_a.none(), "period"_a, "progress"_a.none(), "cancel"_a.none());
	module.def("sample_surface", &sample_surface, "vertices"_a, "faces"_a, "radius"_a, "seed"_a, "window"_a.none(),
			"levels"_a, "layer"_a, "progress"_a.none(), "cancel"_a.none());
	const auto define_domain = [&](const char *name, auto function) {
		module.def(name, function, "size"_a, "radius"_a, "seed"_a, "method"_a, "toroidal"_a, "cell_size"_a,
				"darts_each"_a, "progress"_a.none(), "cancel"_a.none());
	};
	define_domain("sample_domain_single", &sample_domain<float>);
	define_domain("sample_domain_double", &sample_domain<double>);
	module.def("period_step", &thicket::period_step, "levels"_a);
	module.def("digest", &digest_of_points, "positions"_a, "ids"_a, "ranks"_a, "levels"_a);
	module.def("domain_digest", &digest_of_domain<double>, "positions"_a.noconvert());
	module.def("domain_digest", &digest_of_domain<float>, "positions"_a.noconvert());
}
