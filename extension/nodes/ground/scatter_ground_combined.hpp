#pragma once

#include "nodes/common/guard.hpp"
#include "nodes/ground/scatter_ground.hpp"

#include <godot_cpp/variant/rect2.hpp>
#include <godot_cpp/variant/typed_array.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace thicket {

/// Several grounds above each other, in any order: at each position, the highest one is used.
/// Registers its hosts with all of them and forwards their signals. The grounds may also be used by
/// themselves, or in several combinations.
class ScatterGroundCombined : public ScatterGround {
	GDCLASS(ScatterGroundCombined, ScatterGround)
	THICKET_GUARDED_METHODS(owner)

public:
	static constexpr const char *class_name = "ScatterGroundCombined";

	/// Ignores null entries. Rejects a list with a ground that contains this one.
	void set_grounds(const godot::TypedArray<ScatterGround> &p_grounds);
	godot::TypedArray<ScatterGround> get_grounds() const;

	godot::String script_problem(const Status &status) const override;
	bool calls_script() const override;
	bool contains(const ScatterGround *p_other) const override;
	void add_used(SceneUse::List &r_used) override;
	bool has_textures() const override;
	bool has_surfaces() const override;
	/// Returns the planet of the first part that forms one.
	Planet planet() const override;
	GroundShell shell(std::uint64_t host, const Planet &planet) const override;
	bool moves_with_host() const override;
	bool needs_physics_frames() const override;
	std::size_t max_positions_per_call() const override;
	bool is_available() const override;
	double recheck_tolerance() const override;
	void search_again() override;
	bool has_unapplied_changes() const override;
	bool is_pending(std::uint64_t host) const override;
	std::vector<Rect> take_removed_areas(std::uint64_t host) override;
	void finish_reading() override;
	GroundFigures figures() const override;

protected:
	static void _bind_methods();
	std::shared_ptr<const Terrain> make_snapshot(const GroundHost &host) override;
	godot::String find_problem() override;
	godot::String find_remark() override;
	godot::String find_export_problem() override;
	bool only_on_main_thread() override;
	Status sample_for(const GroundHost &host, std::span<const glm::dvec2> positions, const GroundNeeds &needs,
			std::span<Ground> r_ground) override;
	bool can_change_unreported() const override;
	Status recheck_for(const GroundHost &host, std::span<const glm::dvec2> positions,
			std::span<std::optional<float>> r_heights) override;
	void hosts_changed(bool first) override;
	void follow() override;
	bool start_rereading() override;
	void offset_changed(const GroundHost &host) override;
	bool is_shared() const override { return true; }

private:
	/// An accepted entry of the list.
	struct Part {
		std::int64_t index = 0; ///< The index in the list.
		godot::Ref<ScatterGround> ground;
	};
	using Parts = std::vector<Part>;

	/// A host that is registered with a ground.
	struct Registration {
		godot::Ref<ScatterGround> ground;
		godot::Node3D *node = nullptr;

		bool operator==(const Registration &other) const { return ground == other.ground && node == other.node; }
	};

	/// Calls `call` for each part that is still in the list. It may run a script, which may do
	/// anything.
	template <class Call>
	void for_each_part(const Call &call) {
		const godot::Ref<ScatterGround> keep_alive(this);
		for (const Part &part : Parts(parts_)) {
			if (has_part(part.ground)) {
				call(part);
			}
		}
	}

	std::vector<std::uint64_t> listed_ids() const;
	void update_parts();
	void watch_parts(const Parts &parts, bool p_watch);
	void update_registrations();
	std::optional<Registration> next_to_unregister() const;
	std::optional<std::size_t> next_to_register(Registration &r_registration) const;
	bool has_part(const godot::Ref<ScatterGround> &p_ground) const;
	godot::String first_message_of(godot::String (ScatterGround::*method)(), bool *r_all_have_message = nullptr);
	godot::String planet_conflict() const;
	void part_changed();
	void part_ground_changed(const godot::Rect2 &p_rect, int64_t p_ground);

	godot::TypedArray<ScatterGround> grounds_;
	/// The instance IDs of `grounds_` when the parts were last determined. Scripts may change the
	/// list without a setter.
	std::vector<std::uint64_t> listed_ids_;
	Parts parts_; ///< The entries that are neither empty, nor duplicates, nor rejected.
	std::vector<Registration> registrations_;
	/// The part whose signal is being forwarded.
	godot::Ref<ScatterGround> emitter_;
};

} // namespace thicket
