#pragma once

#include "core/state/diff_limits.hpp"
#include "nodes/common/guard.hpp"

#include <godot_cpp/classes/resource.hpp>
#include <godot_cpp/variant/rect2.hpp>

#include <cstdint>

namespace thicket {

/// Limits on how diffs (changes as bytes, from peers) may change a ScatterState. The defaults of a
/// new object suit a server that receives diffs from players. A state without limits uses the
/// defaults of DiffLimits, which suit a client that receives its server's diffs. Setting a property
/// to a value out of range prints an error and leaves the property unchanged.
class ScatterDiffLimits : public godot::Resource, public ThreadGuarded {
	GDCLASS(ScatterDiffLimits, godot::Resource)
	THICKET_GUARDED_METHODS(owner)

public:
	/// These setters limit counts, each from 0 to max_count; see DiffLimits.
	void set_max_changes(int64_t p_count);
	int64_t get_max_changes() const { return static_cast<int64_t>(limits_.max_changes); }
	void set_max_total_changes(int64_t p_count);
	int64_t get_max_total_changes() const { return static_cast<int64_t>(limits_.max_total_changes); }
	void set_max_added(int64_t p_count);
	int64_t get_max_added() const { return static_cast<int64_t>(limits_.max_added); }

	/// Sets the maximum size of an instance's data in bytes, 0 to max_instance_data.
	void set_max_data_size(int64_t p_bytes);
	int64_t get_max_data_size() const { return static_cast<int64_t>(limits_.max_data_size); }

	/// Sets the area in which diffs may change instances, in world meters. All numbers must be
	/// finite. A rectangle without an area disables this limit.
	void set_area(const godot::Rect2 &p_area);
	godot::Rect2 get_area() const { return area_; }

	void set_allow_replacement(bool p_allow);
	bool is_replacement_allowed() const { return limits_.allow_replacement; }

	/// Sets by how many seconds a diff may advance the clock, 0 to max_state_time.
	void set_max_clock_advance(double p_seconds);
	double get_max_clock_advance() const { return limits_.max_clock_advance; }

	const DiffLimits &limits() const { return limits_; }

	static constexpr const char *class_name = "ScatterDiffLimits";
	static constexpr int64_t max_count = int64_t{1} << 31;

protected:
	static void _bind_methods();

private:
	void set_count(const char *p_property, int64_t p_count, int64_t p_max, std::uint64_t &r_limit);

	/// The defaults suit a server, which expects only small changes from players.
	DiffLimits limits_{.max_changes = 65536,
			.max_total_changes = 1'000'000,
			.max_added = 65536,
			.max_data_size = 4096,
			.allow_replacement = false,
			.max_clock_advance = 0.0};
	godot::Rect2 area_;
};

} // namespace thicket
