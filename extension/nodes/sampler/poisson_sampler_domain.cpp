#include "nodes/sampler/poisson_sampler.hpp"

#include "core/base/check.hpp"
#include "core/base/guard.hpp"
#include "nodes/common/convert.hpp"
#include "nodes/common/engine_arrays.hpp"
#include "nodes/common/property_check.hpp"
#include "nodes/common/threads.hpp"
#include "nodes/sampler/script_progress.hpp"

#include <godot_cpp/core/error_macros.hpp>
#include <godot_cpp/variant/packed_float64_array.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>

using namespace godot;

namespace thicket {

namespace {

/// Returns the largest number below `end`, but at least `min`.
template <typename Real>
Real largest_below(Real end, Real min) {
	return std::max(std::nextafter(end, -std::numeric_limits<Real>::infinity()), min);
}

/// Writes positions in single precision, all of which pass Rect2.has_point for the rectangle.
class Vector2Writer {
public:
	explicit Vector2Writer(const Rect2 &p_rect) :
			max_position_(largest_below(p_rect.position.x + p_rect.size.x, p_rect.position.x),
					largest_below(p_rect.position.y + p_rect.size.y, p_rect.position.y)) {}

	/// Throws std::bad_alloc if there is not enough memory.
	void resize(std::size_t p_count) {
		next_position_ = thicket::resize(positions, static_cast<int64_t>(p_count)).data();
	}

	void add(const glm::dvec2 &p_position) {
		*next_position_++ = Vector2(std::min(static_cast<real_t>(p_position.x), max_position_.x),
				std::min(static_cast<real_t>(p_position.y), max_position_.y));
	}

	PackedVector2Array positions;

private:
	Vector2 max_position_;
	Vector2 *next_position_ = nullptr;
};

/// Writes positions in double precision, all of which lie before the far edges.
class DoubleWriter {
public:
	explicit DoubleWriter(const Rect &p_rect) :
			max_position_(largest_below(p_rect.max.x, p_rect.min.x), largest_below(p_rect.max.y, p_rect.min.y)) {}

	/// Throws std::bad_alloc if there is not enough memory.
	void resize(std::size_t p_count) {
		next_x_ = thicket::resize(x, static_cast<int64_t>(p_count)).data();
		next_y_ = thicket::resize(y, static_cast<int64_t>(p_count)).data();
	}

	void add(const glm::dvec2 &p_position) {
		*next_x_++ = std::min(p_position.x, max_position_.x);
		*next_y_++ = std::min(p_position.y, max_position_.y);
	}

	PackedFloat64Array x;
	PackedFloat64Array y;

private:
	glm::dvec2 max_position_;
	double *next_x_ = nullptr;
	double *next_y_ = nullptr;
};

/// Writes `position_of(point)` for each point and checks for cancellation between batches.
template <typename Points, typename PositionOf, typename Writer>
Status write(const Points &points, const PositionOf &position_of, const Progress &progress, Writer &r_writer) {
	constexpr std::size_t batch_size = 1 << 20;
	const Status status = guarded("rect", static_cast<double>(points.size()), [&] { r_writer.resize(points.size()); });
	if (!status.ok()) {
		return status;
	}
	for (std::size_t start = 0; start < points.size(); start += batch_size) {
		if (progress.cancelled()) {
			return {ErrorCode::cancelled, "sample_domain", 0.0};
		}
		for (std::size_t index = start; index < std::min(start + batch_size, points.size()); ++index) {
			r_writer.add(position_of(points[index]));
		}
	}
	return {};
}

template <typename Real, typename Writer>
Status write_set(const DomainRequest &request, const glm::dvec2 &min, const Progress &progress, Writer &r_writer,
		DomainStats &r_stats) {
	DomainSampler<Real> sampler;
	std::vector<glm::vec<2, Real>> points;
	const Status status = sampler.sample(request, points, progress);
	if (!status.ok()) {
		return status;
	}
	r_stats = sampler.stats();
	return write(points, [&](const glm::vec<2, Real> &point) { return min + glm::dvec2(point); }, progress, r_writer);
}

/// Returns the advice to print for script authors if the core has rejected a size; empty for other
/// errors.
String advice_for(const DomainRequest &request, const Status &status) {
	if (status.code != ErrorCode::out_of_range) {
		return String();
	}
	if (request.toroidal && status.value < min_torus_radii * request.radius) {
		return vformat("; a toroidal domain must measure at least %d radii on each axis",
				static_cast<int64_t>(min_torus_radii));
	}
	return vformat("; in single precision, a domain may measure at most %d radii: set double_precision",
			static_cast<int64_t>(max_single_radii));
}

} // namespace

DomainRequest PoissonSampler::domain_request(const glm::dvec2 &p_size) const {
	constexpr std::array methods{
			DomainMethod::naive, DomainMethod::hierarchical, DomainMethod::accumulator, DomainMethod::wavefront};
	DomainRequest request;
	request.size = p_size;
	request.radius = set_.radius;
	request.seed = set_.seed;
	request.method = methods[static_cast<std::size_t>(std::max<int64_t>(method_ - METHOD_NAIVE, 0))];
	request.toroidal = toroidal_;
	request.cell_size = cell_size_;
	return request;
}

// Prints an error in the script's terms: the core rejects a `size`, but scripts pass a rectangle.
void PoissonSampler::report_domain(const DomainRequest &p_request, Status p_status) const {
	if (std::string_view(p_status.property) != "size" || p_status.code == ErrorCode::cancelled) {
		report(class_name, p_status);
		return;
	}
	p_status.property = "rect.size";
	ERR_PRINT(sentence(class_name, p_status) + advice_for(p_request, p_status));
}

template <typename Writer>
Status PoissonSampler::write_tiles(
		const Rect &p_rect, const Progress &p_progress, Writer &r_writer, DomainStats &r_stats) {
	const PointSet set = set_; // Use a copy, because a progress callable may change the properties.
	EngineThreads threads;
	const Status status = sampler_.sample(set, p_rect, points_, p_progress, &threads);
	if (!status.ok()) {
		return status;
	}
	const SampleStats &stats = sampler_.stats();
	r_stats.points = stats.kept;
	r_stats.darts = stats.darts;
	r_stats.squares = stats.squares;
	r_stats.grid_bytes = stats.workspace_bytes;
	return write(points_, [](const SamplePoint &point) { return point.position; }, p_progress, r_writer);
}

template <typename Writer>
Status PoissonSampler::write_by_method(const Rect &p_rect, const DomainRequest &p_request, const Progress &p_progress,
		Writer &r_writer, DomainStats &r_stats) {
	constexpr double max_coordinate = std::numeric_limits<double>::max();
	const Status status = first_failure(check_range("rect", p_rect.min.x, -max_coordinate, max_coordinate),
			check_range("rect", p_rect.min.y, -max_coordinate, max_coordinate),
			check_positive("size", p_request.size.x), check_positive("size", p_request.size.y));
	if (!status.ok()) {
		return status;
	}
	if (method_ == METHOD_TILES) {
		return write_tiles(p_rect, p_progress, r_writer, r_stats);
	}
	return double_precision_ ? write_set<double>(p_request, p_rect.min, p_progress, r_writer, r_stats)
							 : write_set<float>(p_request, p_rect.min, p_progress, r_writer, r_stats);
}

template <typename Writer>
void PoissonSampler::write_domain(const CallScope &p_scope, const Rect &p_rect, const glm::dvec2 &p_size,
		const Callable &p_progress, Writer &r_writer) {
	if (!p_scope.is_granted()) {
		return;
	}
	if (method_ == METHOD_TILES && toroidal_) {
		ERR_PRINT(String("PoissonSampler.toroidal must be false for METHOD_TILES, got true: an infinite set has no "
						 "opposite edges; choose another method"));
		return;
	}
	const DomainRequest request = domain_request(p_size);
	ScriptProgress script(class_name, p_progress);
	const Progress progress = script.progress(&is_cancelled_);
	DomainStats stats;
	const Status status = write_by_method(p_rect, request, progress, r_writer, stats);
	if (status.ok()) {
		script.finish(stats.points);
	}
	if (status.ok() && !progress.cancelled()) {
		stats_ = stats;
	} else {
		report_domain(request, status);
		r_writer.resize(0);
	}
}

PackedVector2Array PoissonSampler::sample_domain(const Rect2 &p_rect, const Callable &p_progress) {
	const CallScope scope(this, "sample_domain");
	Vector2Writer writer(p_rect);
	write_domain(scope, to_core(p_rect), to_core(p_rect.size), p_progress, writer);
	return writer.positions;
}

Ref<PoissonPoints> PoissonSampler::sample_domain_exact(
		double p_min_x, double p_min_y, double p_max_x, double p_max_y, const Callable &p_progress) {
	const CallScope scope(this, "sample_domain_exact");
	const Rect rect{{p_min_x, p_min_y}, {p_max_x, p_max_y}};
	DoubleWriter writer(rect);
	write_domain(scope, rect, rect.size(), p_progress, writer);
	return PoissonPoints::of_positions(writer.x, writer.y);
}

Dictionary PoissonSampler::get_stats() const {
	Dictionary result;
	const auto add = [&result](const char *name, std::uint64_t value) {
		result[name] = static_cast<int64_t>(value);
	};
	add("points", stats_.points);
	add("darts", stats_.darts);
	add("squares", stats_.squares);
	add("selections", stats_.selections);
	add("list_checks", stats_.list_checks);
	add("discarded", stats_.discarded);
	add("workspace_bytes", stats_.workspace_bytes());
	return result;
}

} // namespace thicket
