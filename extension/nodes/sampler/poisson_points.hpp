#pragma once

#include "core/sampling/point_set.hpp"
#include "nodes/common/guard.hpp"

#include <godot_cpp/classes/ref.hpp>
#include <godot_cpp/classes/ref_counted.hpp>
#include <godot_cpp/core/memory.hpp>
#include <godot_cpp/variant/packed_float32_array.hpp>
#include <godot_cpp/variant/packed_float64_array.hpp>
#include <godot_cpp/variant/packed_int64_array.hpp>
#include <godot_cpp/variant/packed_vector2_array.hpp>
#include <godot_cpp/variant/vector2.hpp>

#include <cstdint>
#include <mutex>
#include <span>

namespace thicket {

/// A rank for scripts: at least 0 and below 1.
float unit_rank(std::uint32_t rank);

/// The points that a PoissonSampler has found. They never change, so any thread may read them. Given an invalid index,
/// methods print an error and return a default.
class PoissonPoints : public godot::RefCounted {
	GDCLASS(PoissonPoints, godot::RefCounted)
	THICKET_GUARDED_METHODS(any)

public:
	static constexpr const char *class_name = "PoissonPoints";

	/// The result of a refused call.
	static godot::Ref<PoissonPoints> make_empty() { return memnew(PoissonPoints); }

	/// Copies points, with positions in single precision, or in double precision if `exact`. If there is not enough memory, prints an error
	/// and returns an empty result.
	static godot::Ref<PoissonPoints> of(std::span<const SamplePoint> points, bool exact);

	/// Stores positions in double precision, as many x as y. These points have neither IDs nor ranks.
	static godot::Ref<PoissonPoints> of_positions(
			const godot::PackedFloat64Array &p_x, const godot::PackedFloat64Array &p_y);

	int64_t size() const { return size_; }
	bool is_empty() const { return size_ == 0; }

	/// The permanent number of a point; 0 for a point of a set without IDs.
	int64_t get_id(int64_t p_index) const;
	godot::Vector2 get_position(int64_t p_index) const;

	/// At least 0 and below 1; 0 for a point of a set without ranks.
	double get_rank(int64_t p_index) const;

	// The IDs, ranks and positions of all points. Each array is empty if the points do not have the values.
	godot::PackedInt64Array get_ids() const { return ids_; }
	godot::PackedFloat32Array get_ranks() const { return ranks_; }
	godot::PackedVector2Array get_positions() const;

	/// Positions in double precision. Empty unless they were requested.
	godot::PackedFloat64Array get_x() const { return x_; }
	godot::PackedFloat64Array get_y() const { return y_; }

protected:
	static void _bind_methods();

private:
	bool has(int64_t p_index) const;
	void fill(std::span<const SamplePoint> points, bool exact);

	int64_t size_ = 0;
	godot::PackedInt64Array ids_;
	godot::PackedFloat32Array ranks_;
	godot::PackedFloat64Array x_;
	godot::PackedFloat64Array y_;
	mutable godot::PackedVector2Array positions_; ///< For exact points: created on first use.
	mutable std::mutex mutex_;                    ///< Guards positions_.
};

} // namespace thicket
