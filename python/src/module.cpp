// The module thicket._core makes the samplers of the core available to Python. It only converts arguments and results.

#include "docs.hpp"
#include "own_threads.hpp"
#include "watcher.hpp"

#include "core/base/check.hpp"
#include "core/sampling/domain/domain_sampler.hpp"
#include "core/sampling/set_digest.hpp"
#include "core/sampling/tile_sampler.hpp"
#include "core/surface/surface_sampler.hpp"

#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace nb = nanobind;

namespace thicket::python {

namespace {

/// The points of a set. Arrays are views into `points` and keep this object alive.
template <typename Point>
struct PointList {
	std::vector<Point> points;

	/// Returns the first point, or a dummy if there is none, because an array needs an address.
	const Point *first() const {
		static const Point dummy{};
		return points.empty() ? &dummy : points.data();
	}
};
using Points = PointList<SamplePoint>;
using SurfacePoints = PointList<SurfacePoint>;

template <typename Number>
using Column = nb::ndarray<nb::numpy, const Number, nb::ndim<1>>;
template <typename Real, nb::ssize_t axes = 2>
using Positions = nb::ndarray<nb::numpy, const Real, nb::shape<-1, axes>>;

/// Returns one member of all points, as an array with the stride of a point.
template <typename Point, typename Number>
Column<Number> column(nb::handle_t<PointList<Point>> self, const Number Point::*member) {
	static_assert(sizeof(Point) % sizeof(Number) == 0);
	const auto &list = nb::cast<const PointList<Point> &>(self);
	return Column<Number>(&(list.first()->*member), {list.points.size()}, self, {sizeof(Point) / sizeof(Number)});
}

/// Returns one vector member of every point, as a two-dimensional array with the stride of a point.
template <typename Point, int axes>
Positions<double, axes> vectors(nb::handle_t<PointList<Point>> self, const glm::vec<axes, double> Point::*member) {
	static_assert(sizeof(Point) % sizeof(double) == 0);
	const auto &list = nb::cast<const PointList<Point> &>(self);
	return Positions<double, axes>(
			&(list.first()->*member).x, {list.points.size(), axes}, self, {sizeof(Point) / sizeof(double), 1});
}

/// Moves a list into an array, which owns it.
template <typename Real>
nb::object array_of(std::vector<glm::vec<2, Real>> &&list) {
	static_assert(sizeof(glm::vec<2, Real>) == 2 * sizeof(Real));
	auto own = std::make_unique<std::vector<glm::vec<2, Real>>>(std::move(list));
	static const glm::vec<2, Real> dummy{0};
	const Real *first = own->empty() ? &dummy.x : &own->front().x;
	const std::size_t count = own->size();
	const nb::capsule owner(
			own.get(), [](void *list) noexcept { delete static_cast<std::vector<glm::vec<2, Real>> *>(list); });
	own.release();
	return nb::cast(Positions<Real>(first, {count, 2}, owner));
}

[[noreturn]] void refuse(const std::string &message) {
	PyErr_SetString(PyExc_ValueError, message.c_str());
	throw nb::python_error();
}

void require(const Status &status) {
	if (!status.ok()) {
		refuse(describe(status));
	}
}

/// Converts a sequence of `count` numbers, which may be an array. `expected` says in the
/// error message what was expected.
template <std::size_t count>
std::array<double, count> numbers(nb::handle sequence, const char *expected) {
	std::array<double, count> found{};
	if (nb::try_cast(sequence, found)) {
		return found;
	}
	const std::string text = nb::cast<std::string>(nb::repr(sequence));
	PyErr_SetString(PyExc_TypeError, (std::string(expected) + ", got " + text).c_str());
	throw nb::python_error();
}

/// Returns a seed of 64 bits from a Python integer, which may be signed, as in the engine, or
/// unsigned.
std::uint64_t seed_of(nb::handle number) {
	const nb::object whole = nb::steal(PyNumber_Index(number.ptr()));
	if (!whole.is_valid()) {
		throw nb::python_error();
	}
	int overflow = 0;
	const long long seed = PyLong_AsLongLongAndOverflow(whole.ptr(), &overflow);
	if (overflow == 0) {
		return static_cast<std::uint64_t>(seed);
	}
	const unsigned long long large = overflow > 0 ? PyLong_AsUnsignedLongLong(whole.ptr()) : 0;
	if (overflow < 0 || PyErr_Occurred() != nullptr) {
		PyErr_Clear();
		refuse("seed must have 64 bits, got " + std::string(nb::str(whole).c_str()));
	}
	return large;
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

PointSet set_of(double radius, nb::handle seed, std::int64_t levels, std::int64_t layer) {
	require(first_failure(check_range("levels", static_cast<double>(levels), 1, max_levels),
			check_range("layer", static_cast<double>(layer), 0, std::numeric_limits<std::uint16_t>::max())));
	return {.seed = seed_of(seed),
			.radius = radius,
			.levels = static_cast<std::uint32_t>(levels),
			.layer = static_cast<std::uint16_t>(layer)};
}

Points sample(nb::handle rect, double radius, nb::handle seed, std::int64_t levels, std::int64_t layer,
		std::int64_t threads, nb::object progress, const Cancel *cancel) {
	const PointSet set = set_of(radius, seed, levels, layer);
	require(check_range("threads", static_cast<double>(threads), 0, max_threads));
	const auto [min_x, min_y, max_x, max_y] =
			numbers<4>(rect, "rect must be four numbers, (min_x, min_y, max_x, max_y)");
	Watcher watcher(std::move(progress), cancel);
	Points sampled;
	Status status;
	{
		const nb::gil_scoped_release unlocked;
		Lease lease;
		OwnThreads others(threads > 0 ? static_cast<std::size_t>(threads) - 1 : OwnThreads::spare());
		status = lease.sampler().sample(
				set, {{min_x, min_y}, {max_x, max_y}}, sampled.points, watcher.progress(), &others);
	}
	watcher.finish(status, describe(status), sampled.points.size());
	return sampled;
}

template <typename Number>
using Triples = nb::ndarray<const Number, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;

/// Returns the vertices to which each face refers, three per face.
std::vector<std::uint32_t> indices_of(const Triples<std::int64_t> &faces, std::size_t vertices) {
	const std::span<const std::int64_t> all(faces.data(), 3 * faces.shape(0));
	std::vector<std::uint32_t> indices;
	indices.reserve(all.size());
	for (const std::int64_t index : all) {
		if (index < 0 || static_cast<std::uint64_t>(index) >= vertices) {
			refuse("faces must have indices of vertices, 0 to " +
					std::to_string(static_cast<std::int64_t>(vertices) - 1) + ", got " + std::to_string(index));
		}
		indices.push_back(static_cast<std::uint32_t>(index));
	}
	return indices;
}

SurfacePoints sample_surface(const Triples<double> &vertices, const Triples<std::int64_t> &faces, double radius,
		nb::handle seed, const std::optional<nb::object> &window, std::int64_t levels, std::int64_t layer,
		nb::object progress, const Cancel *cancel) {
	const PointSet set = set_of(radius, seed, levels, layer);
	Box3 box;
	if (window) {
		const auto [min_x, min_y, min_z, max_x, max_y, max_z] =
				numbers<6>(*window, "window must be six numbers, (min_x, min_y, min_z, max_x, max_y, max_z)");
		box = {{min_x, min_y, min_z}, {max_x, max_y, max_z}};
	}
	const auto *first = reinterpret_cast<const glm::dvec3 *>(vertices.data());
	std::vector<glm::dvec3> corners(first, first + vertices.shape(0));
	std::vector<std::uint32_t> indices = indices_of(faces, corners.size());
	Watcher watcher(std::move(progress), cancel);
	SurfacePoints sampled;
	Status status;
	{
		const nb::gil_scoped_release unlocked;
		std::shared_ptr<const Surface> surface;
		status = Surface::create(std::move(corners), std::move(indices), surface);
		if (status.ok()) {
			SurfaceSampler sampler;
			status = window ? sampler.sample(set, *surface, box, sampled.points, watcher.progress())
							: sampler.sample_all(set, *surface, sampled.points, watcher.progress());
		}
	}
	watcher.finish(status, describe(status), sampled.points.size());
	return sampled;
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
	refuse("method must be one of " + names + ", got '" + name + "'");
}

template <typename Real>
nb::object fill(const DomainRequest &request, Watcher &r_watcher) {
	std::vector<glm::vec<2, Real>> points;
	Status status;
	{
		const nb::gil_scoped_release unlocked;
		status = DomainSampler<Real>().sample(request, points, r_watcher.progress());
	}
	r_watcher.finish(status, describe(request, status), points.size());
	return array_of(std::move(points));
}

nb::object sample_domain(nb::handle size, double radius, nb::handle seed, const std::string &method, bool toroidal,
		const std::string &precision, double cell_size, double darts_each, nb::object progress, const Cancel *cancel) {
	if (precision != "single" && precision != "double") {
		refuse("precision must be 'single' or 'double', got '" + precision + "'");
	}
	const auto [width, height] = numbers<2>(size, "size must be two numbers, (width, height)");
	const DomainRequest request{.size = {width, height},
			.radius = radius,
			.seed = seed_of(seed),
			.method = method_of(method),
			.toroidal = toroidal,
			.cell_size = cell_size,
			.darts_each = darts_each};
	Watcher watcher(std::move(progress), cancel);
	return precision == "single" ? fill<float>(request, watcher) : fill<double>(request, watcher);
}

std::pair<std::uint64_t, std::uint64_t> digest_of_points(const Points &points) {
	const nb::gil_scoped_release unlocked;
	const SetDigest digests = digest(std::span<const SamplePoint>(points.points));
	return {digests.points, digests.ranks};
}

template <typename Real>
std::uint64_t digest_of_domain(
		const nb::ndarray<const Real, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu> &positions) {
	const auto *first = reinterpret_cast<const glm::vec<2, Real> *>(positions.data());
	const std::size_t count = positions.shape(0);
	const nb::gil_scoped_release unlocked;
	return digest(std::span<const glm::vec<2, Real>>(first, count));
}

/// Declares the class for the points of a set, with the members that the points of all sets have.
template <typename Point>
nb::class_<PointList<Point>> bind_list(nb::module_ &module, const char *name, const char *doc, const char *ids) {
	using Self = nb::handle_t<PointList<Point>>;
	const std::string title = std::string("<thicket.") + name + " of ";
	return nb::class_<PointList<Point>>(module, name, doc)
			.def("__len__", [](const PointList<Point> &self) { return self.points.size(); })
			.def("__repr__",
					[title](const PointList<Point> &self) {
						return title + std::to_string(self.points.size()) + " points>";
					})
			.def_prop_ro(
					"ids", [](Self self) { return column(self, &Point::id); },
					nb::sig("def ids(self) -> numpy.typing.NDArray[numpy.uint64]"), ids)
			.def_prop_ro(
					"ranks", [](Self self) { return column(self, &Point::rank); },
					nb::sig("def ranks(self) -> numpy.typing.NDArray[numpy.uint32]"), doc::ranks)
			.def_prop_ro(
					"levels", [](Self self) { return column(self, &Point::level); },
					nb::sig("def levels(self) -> numpy.typing.NDArray[numpy.uint32]"), doc::levels);
}

void bind_points(nb::module_ &module) {
	bind_list<SamplePoint>(module, "Points", doc::points, doc::ids)
			.def_prop_ro(
					"positions", [](nb::handle_t<Points> self) { return vectors(self, &SamplePoint::position); },
					nb::sig(doc::positions_type), doc::positions)
			.def("digest", &digest_of_points, doc::digest);
	using Self = nb::handle_t<SurfacePoints>;
	bind_list<SurfacePoint>(module, "SurfacePoints", doc::surface_points, doc::surface_ids)
			.def_prop_ro(
					"positions", [](Self self) { return vectors(self, &SurfacePoint::position); },
					nb::sig("def positions(self) -> " THICKET_VECTORS), doc::surface_positions)
			.def_prop_ro(
					"normals", [](Self self) { return vectors(self, &SurfacePoint::normal); },
					nb::sig("def normals(self) -> " THICKET_VECTORS), doc::surface_normals)
			.def_prop_ro(
					"faces", [](Self self) { return column(self, &SurfacePoint::triangle); },
					nb::sig("def faces(self) -> numpy.typing.NDArray[numpy.uint32]"), doc::surface_faces);
}

void bind_functions(nb::module_ &module) {
	using nb::literals::operator""_a;
	module.def("sample_surface", &sample_surface, "vertices"_a, "faces"_a, "radius"_a, "seed"_a = 0, nb::kw_only(),
			"window"_a = nb::none(), "levels"_a = 1, "layer"_a = 0, "progress"_a = nb::none(), "cancel"_a = nb::none(),
			nb::sig(doc::sample_surface_type), doc::sample_surface);
	module.def("sample", &sample, "rect"_a, "radius"_a, "seed"_a = 0, nb::kw_only(), "levels"_a = 1, "layer"_a = 0,
			"threads"_a = 1, "progress"_a = nb::none(), "cancel"_a = nb::none(), nb::sig(doc::sample_type),
			doc::sample);
	// The first signature handles every call. The second only adds its type to the stubs.
	for (const auto &[type, words] :
			{std::pair{doc::sample_domain_double, doc::sample_domain}, std::pair{doc::sample_domain_single, ""}}) {
		module.def("sample_domain", &sample_domain, "size"_a, "radius"_a, "seed"_a = 0, nb::kw_only(),
				"method"_a = "hierarchical", "toroidal"_a = false, "precision"_a = "double", "cell_size"_a = 0.0,
				"darts_each"_a = DomainRequest().darts_each, "progress"_a = nb::none(), "cancel"_a = nb::none(),
				nb::sig(type), words);
	}
	module.def(
			"domain_digest", &digest_of_domain<double>, "positions"_a.noconvert(), nb::sig(doc::domain_digest_double));
	module.def("domain_digest", &digest_of_domain<float>, "positions"_a.noconvert(), nb::sig(doc::domain_digest_single),
			doc::domain_digest);
}

} // namespace

} // namespace thicket::python

NB_MODULE(_core, module) {
	using namespace thicket::python;
	module.doc() = "The samplers of Thicket's core. Import thicket instead, which exports the same names.";
	nb::class_<Cancel>(module, "Cancel", doc::cancel)
			.def(nb::init<>())
			.def("cancel", &Cancel::cancel, doc::cancel_cancel)
			.def_prop_ro("cancelled", &Cancel::cancelled, doc::cancel_cancelled);
	nb::exception<Cancelled>(module, "Cancelled", PyExc_RuntimeError).attr("__doc__") =
			"Raised when a Cancel has ended a call.";
	bind_points(module);
	bind_functions(module);
}
