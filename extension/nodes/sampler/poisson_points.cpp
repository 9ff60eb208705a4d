#include "nodes/sampler/poisson_points.hpp"

#include "core/base/guard.hpp"
#include "nodes/common/bind_value.hpp"
#include "nodes/common/convert.hpp"
#include "nodes/common/engine_arrays.hpp"
#include "nodes/common/property_check.hpp"
#include "nodes/common/threads.hpp"

#include <godot_cpp/core/class_db.hpp>
#include <godot_cpp/core/memory.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>

using namespace godot;

namespace thicket {

namespace {

constexpr double rank_scale = 1.0 / 4294967296.0;

/// Processes the points in chunks. If there are many, distributes the chunks among the engine's
/// worker threads. Most of the time is spent in page faults: the system maps new memory one page at
/// a time.
template <class Work>
void for_each_chunk(std::size_t size, const Work &work) {
	constexpr std::size_t chunk_size = 1 << 14;
	std::atomic<std::size_t> next_first = 0;
	const auto work_on = [&](std::size_t) {
		for (std::size_t first = next_first.fetch_add(chunk_size); first < size;
				first = next_first.fetch_add(chunk_size)) {
			work(first, std::min(first + chunk_size, size));
		}
	};
	if (size > 4 * chunk_size) {
		// The result does not depend on which thread copies which chunk.
		EngineThreads().run(work_on);
	} else {
		work_on(0);
	}
}

} // namespace

float unit_rank(std::uint32_t rank) {
	// A rank just below 2^32 must not round up to 1.
	return std::min(static_cast<float>(rank * rank_scale), std::nextafter(1.0F, 0.0F));
}

Ref<PoissonPoints> PoissonPoints::of(std::span<const SamplePoint> points, bool exact) {
	const Ref<PoissonPoints> result(memnew(PoissonPoints));
	const Status status = guarded("rect", static_cast<double>(points.size()), [&] { result->fill(points, exact); });
	report("PoissonSampler", status);
	return status.ok() ? result : Ref<PoissonPoints>(memnew(PoissonPoints));
}

Ref<PoissonPoints> PoissonPoints::of_positions(const PackedFloat64Array &p_x, const PackedFloat64Array &p_y) {
	Ref<PoissonPoints> result(memnew(PoissonPoints));
	result->x_ = p_x;
	result->y_ = p_y;
	result->size_ = p_x.size();
	return result;
}

void PoissonPoints::fill(std::span<const SamplePoint> points, bool exact) {
	const auto count = static_cast<int64_t>(points.size());
	int64_t *ids = resize(ids_, count).data();
	float *ranks = resize(ranks_, count).data();
	double *x = resize(x_, exact ? count : 0).data();
	double *y = resize(y_, exact ? count : 0).data();
	Vector2 *positions = resize(positions_, exact ? 0 : count).data();
	for_each_chunk(points.size(), [&](std::size_t first, std::size_t end) {
		const std::span<const SamplePoint> chunk = points.subspan(first, end - first);
		std::ranges::transform(chunk, ids + first, [](const SamplePoint &point) { return script_id(point.id); });
		std::ranges::transform(chunk, ranks + first, [](const SamplePoint &point) { return unit_rank(point.rank); });
		if (exact) {
			std::ranges::transform(chunk, x + first, [](const SamplePoint &point) { return point.position.x; });
			std::ranges::transform(chunk, y + first, [](const SamplePoint &point) { return point.position.y; });
		} else {
			std::ranges::transform(
					chunk, positions + first, [](const SamplePoint &point) { return to_engine(point.position); });
		}
	});
	size_ = count;
}

bool PoissonPoints::has(int64_t p_index) const {
	if (p_index < 0 || p_index >= size_) {
		report(class_name, Status::out_of_range("index", p_index, between(0, size_ - 1, "see size()")));
		return false;
	}
	return true;
}

int64_t PoissonPoints::get_id(int64_t p_index) const {
	return has(p_index) && p_index < ids_.size() ? ids_[p_index] : 0;
}

double PoissonPoints::get_rank(int64_t p_index) const {
	return has(p_index) && p_index < ranks_.size() ? static_cast<double>(ranks_[p_index]) : 0.0;
}

Vector2 PoissonPoints::get_position(int64_t p_index) const {
	if (!has(p_index)) {
		return {};
	}
	return x_.size() == size_ ? to_engine(glm::dvec2(x_[p_index], y_[p_index])) : positions_.ptr()[p_index];
}

PackedVector2Array PoissonPoints::get_positions() const {
	const std::lock_guard lock(mutex_);
	if (positions_.size() == size_) {
		// The points are immutable, so this conversion runs only once.
		return positions_;
	}
	PackedVector2Array positions;
	const std::span<Vector2> output = resize(positions, size_);
	const double *x = x_.ptr();
	const double *y = y_.ptr();
	for (std::size_t index = 0; index < output.size(); ++index) {
		output[index] = to_engine(glm::dvec2(x[index], y[index]));
	}
	positions_ = positions;
	return positions;
}

void PoissonPoints::_bind_methods() {
	using Self = PoissonPoints;
	bind_guarded<&Self::size>(D_METHOD("size"));
	bind_guarded<&Self::is_empty>(D_METHOD("is_empty"));
	bind_guarded<&Self::get_id>(D_METHOD("get_id", "index"));
	bind_guarded<&Self::get_position>(D_METHOD("get_position", "index"));
	bind_guarded<&Self::get_rank>(D_METHOD("get_rank", "index"));
	bind_guarded<&Self::get_ids>(D_METHOD("get_ids"));
	bind_guarded<&Self::get_positions>(D_METHOD("get_positions"));
	bind_guarded<&Self::get_ranks>(D_METHOD("get_ranks"));
	bind_guarded<&Self::get_x>(D_METHOD("get_x"));
	bind_guarded<&Self::get_y>(D_METHOD("get_y"));
	bind_value(class_name, PropertyInfo(Variant::PACKED_INT64_ARRAY, "ids"), "get_ids");
	bind_value(class_name, PropertyInfo(Variant::PACKED_VECTOR2_ARRAY, "positions"), "get_positions");
	bind_value(class_name, PropertyInfo(Variant::PACKED_FLOAT32_ARRAY, "ranks"), "get_ranks");
	bind_value(class_name, PropertyInfo(Variant::PACKED_FLOAT64_ARRAY, "x"), "get_x");
	bind_value(class_name, PropertyInfo(Variant::PACKED_FLOAT64_ARRAY, "y"), "get_y");
}

} // namespace thicket
