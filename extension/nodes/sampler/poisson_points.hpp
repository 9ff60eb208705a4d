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

/// Converts a rank to a fraction in [0, 1) for scripts.
float unit_rank(std::uint32_t rank);

/// The points that a PoissonSampler has generated. Immutable, so any thread may read them. For an
/// invalid index, methods print an error and return 0 or Vector2().
class PoissonPoints : public godot::RefCounted {
	GDCLASS(PoissonPoints, godot::RefCounted)
	THICKET_GUARDED_METHODS(any)

public:
	static constexpr const char *class_name = "PoissonPoints";

	/// Creates the result of a rejected call: no points.
	static godot::Ref<PoissonPoints> make_empty() { return memnew(PoissonPoints); }

	/// Copies points. Stores their positions in double precision if `exact` is true, otherwise in
	/// single precision. If memory runs out, prints an error and returns an empty result.
	static godot::Ref<PoissonPoints> of(std::span<const SamplePoint> points, bool exact);

	/// Creates points without IDs and ranks from coordinates in double precision. Both arrays must
	/// have the same size.
	static godot::Ref<PoissonPoints> of_positions(
			const godot::PackedFloat64Array &p_x, const godot::PackedFloat64Array &p_y);

	int64_t size() const { return size_; }
	bool is_empty() const { return size_ == 0; }

	/// Returns the ID of a point, which never changes; 0 if the points have no IDs.
	int64_t get_id(int64_t p_index) const;
	godot::Vector2 get_position(int64_t p_index) const;

	/// Returns the rank of a point in [0, 1); 0 if the points have no ranks.
	double get_rank(int64_t p_index) const;

	// These methods return the IDs, ranks and positions of all points. The IDs and ranks are empty
	// if the points have none.
	godot::PackedInt64Array get_ids() const { return ids_; }
	godot::PackedFloat32Array get_ranks() const { return ranks_; }
	godot::PackedVector2Array get_positions() const;

	/// Returns the coordinates in double precision; empty if the positions are stored in single
	/// precision.
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
	/// The positions. If `x_` and `y_` contain the coordinates, they are converted on first use.
	mutable godot::PackedVector2Array positions_;
	mutable std::mutex mutex_; ///< Guards positions_.
};

} // namespace thicket
