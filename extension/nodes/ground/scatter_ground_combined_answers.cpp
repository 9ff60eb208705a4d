// This file contains the methods of ScatterGroundCombined that combine the results of its parts.

#include "nodes/ground/scatter_ground_combined.hpp"

#include "core/terrain/combined_terrain.hpp"
#include "nodes/common/property_check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace godot;

namespace thicket {

namespace {

/// Calls `sample(terrain)` with the current ground of a part that any thread may sample. Does
/// nothing if there is no ground.
template <class Sample>
Status sample_snapshot(const Ref<ScatterGround> &p_ground, const GroundHost &host, const Sample &sample) {
	const std::shared_ptr<const Terrain> terrain = p_ground->snapshot(host.id);
	return terrain != nullptr ? sample(*terrain) : Status();
}

String name_of_part(std::int64_t index) { return vformat("ScatterGroundCombined.grounds[%d]", index); }

} // namespace

std::shared_ptr<const Terrain> ScatterGroundCombined::make_snapshot(const GroundHost &host) {
	if (only_on_main_thread()) {
		return nullptr;
	}
	std::vector<CombinedTerrain::Part> terrains;
	for_each_part([&](const Part &part) {
		if (std::shared_ptr<const Terrain> terrain = part.ground->snapshot(host.id)) {
			terrains.push_back(std::move(terrain));
		}
	});
	if (terrains.empty()) {
		return nullptr;
	}
	auto combined_terrain = std::make_shared<CombinedTerrain>();
	const Status status = combined_terrain->set(terrains);
	report(class_name, status);
	return status.ok() ? combined_terrain : nullptr;
}

/// Returns the first message of a part that is not empty, with the part's index.
String ScatterGroundCombined::first_message_of(String (ScatterGround::*method)(), bool *r_all_have_message) {
	String first_message;
	bool all_have_message = true;
	for_each_part([&](const Part &part) {
		const String message = (part.ground.ptr()->*method)();
		all_have_message = all_have_message && !message.is_empty();
		if (first_message.is_empty() && !message.is_empty()) {
			first_message = name_of_part(part.index) + String(": ") + message;
		}
	});
	if (r_all_have_message != nullptr) {
		*r_all_have_message = all_have_message;
	}
	return first_message;
}

/// If only some grounds have a problem, the others can be used.
String ScatterGroundCombined::find_problem() {
	if (parts_.empty()) {
		return "ScatterGroundCombined.grounds is empty: add at least one ScatterGround.";
	}
	bool all_have_problems = false;
	const String problem = first_message_of(&ScatterGround::problem, &all_have_problems);
	return all_have_problems ? problem : String();
}

String ScatterGroundCombined::find_remark() {
	if (const String problem = first_message_of(&ScatterGround::problem); !problem.is_empty()) {
		return problem;
	}
	for (std::int64_t index = 0; index < grounds_.size(); ++index) {
		const Ref<ScatterGround> ground = grounds_[index];
		if (ground.is_null()) {
			return name_of_part(index) +
					String(" is empty and has no effect. Assign a ScatterGround, or remove the entry.");
		}
		const auto part = std::ranges::find(parts_, ground, &Part::ground);
		if (part == parts_.end() || part->index != index) {
			return name_of_part(index) +
					String(" has no effect: the ground is already in the list, or contains this one. Remove the "
						   "entry.");
		}
	}
	const String conflict = planet_conflict();
	return conflict.is_empty() ? first_message_of(&ScatterGround::remark) : conflict;
}

String ScatterGroundCombined::find_export_problem() { return first_message_of(&ScatterGround::export_problem); }

String ScatterGroundCombined::script_problem(const Status &status) const {
	String problem;
	for (const Part &part : parts_) {
		problem = problem.is_empty() ? part.ground->script_problem(status) : problem;
	}
	return problem;
}

bool ScatterGroundCombined::calls_script() const {
	return std::ranges::any_of(parts_, [](const Part &part) { return part.ground->calls_script(); });
}

bool ScatterGroundCombined::contains(const ScatterGround *p_other) const {
	return ScatterGround::contains(p_other) ||
			std::ranges::any_of(parts_, [p_other](const Part &part) { return part.ground->contains(p_other); });
}

void ScatterGroundCombined::add_used(SceneUse::List &r_used) {
	ScatterGround::add_used(r_used);
	for (const Part &part : parts_) {
		part.ground->add_used(r_used);
	}
}

bool ScatterGroundCombined::has_textures() const {
	return std::ranges::any_of(parts_, [](const Part &part) { return part.ground->has_textures(); });
}

Planet ScatterGroundCombined::planet() const {
	for (const Part &part : Parts(parts_)) {
		if (const Planet planet = part.ground->planet(); planet.exists()) {
			return planet;
		}
	}
	return {};
}

GroundShell ScatterGroundCombined::shell(std::uint64_t host, const Planet &planet) const {
	GroundShell result;
	for (const Part &part : Parts(parts_)) {
		result.add(part.ground->shell(host, planet));
	}
	return result;
}

std::vector<Rect> ScatterGroundCombined::take_removed_areas(std::uint64_t host) {
	std::vector<Rect> result;
	for (const Part &part : Parts(parts_)) {
		const std::vector<Rect> areas = part.ground->take_removed_areas(host);
		result.insert(result.end(), areas.begin(), areas.end());
	}
	return result;
}

/// Returns a message about a part whose planet differs from that of an earlier part. Empty if there
/// is no such part.
String ScatterGroundCombined::planet_conflict() const {
	const Planet first = planet();
	for (const Part &part : Parts(parts_)) {
		if (const Planet other = part.ground->planet(); other.exists() && other != first) {
			return name_of_part(part.index) +
					String(" has a different planet_radius or planet_center than an earlier ground, so its planet has "
						   "no effect. Use the same values, or a TerrainScatter3D for each planet.");
		}
	}
	return {};
}

bool ScatterGroundCombined::moves_with_host() const {
	const Parts parts = parts_;
	return std::ranges::all_of(parts, [](const Part &part) { return part.ground->moves_with_host(); });
}

/// If a part must be sampled on the main thread, there is no snapshot, and so there are no
/// surfaces.
bool ScatterGroundCombined::has_surfaces() const {
	bool any_has_surfaces = false;
	bool any_main_thread_only = false;
	for (const Part &part : Parts(parts_)) {
		any_has_surfaces = any_has_surfaces || part.ground->has_surfaces();
		any_main_thread_only = any_main_thread_only || part.ground->is_main_thread_only();
	}
	return any_has_surfaces && !any_main_thread_only;
}

bool ScatterGroundCombined::only_on_main_thread() {
	bool any_main_thread_only = false;
	for_each_part([&any_main_thread_only](const Part &part) {
		any_main_thread_only = part.ground->is_main_thread_only() || any_main_thread_only;
	});
	return any_main_thread_only;
}

bool ScatterGroundCombined::needs_physics_frames() const {
	return std::ranges::any_of(parts_, [](const Part &part) { return part.ground->needs_physics_frames(); });
}

std::size_t ScatterGroundCombined::max_positions_per_call() const {
	std::size_t min_count = std::numeric_limits<std::size_t>::max();
	for (const Part &part : Parts(parts_)) {
		if (part.ground->is_main_thread_only()) {
			min_count = std::min(min_count, part.ground->max_positions_per_call());
		}
	}
	return min_count;
}

bool ScatterGroundCombined::is_available() const {
	return std::ranges::all_of(parts_, [](const Part &part) { return part.ground->is_available(); });
}

bool ScatterGroundCombined::can_change_unreported() const {
	return std::ranges::any_of(parts_, [](const Part &part) { return part.ground->rechecks(); });
}

double ScatterGroundCombined::recheck_tolerance() const {
	double max_tolerance = 0.0;
	for (const Part &part : parts_) {
		max_tolerance =
				part.ground->rechecks() ? std::max(max_tolerance, part.ground->recheck_tolerance()) : max_tolerance;
	}
	return max_tolerance;
}

bool ScatterGroundCombined::has_unapplied_changes() const {
	return listed_ids() != listed_ids_ ||
			std::ranges::any_of(parts_, [](const Part &part) { return part.ground->has_unapplied_changes(); });
}

bool ScatterGroundCombined::is_pending(std::uint64_t host) const {
	return std::ranges::any_of(parts_, [host](const Part &part) { return part.ground->is_pending(host); });
}

GroundFigures ScatterGroundCombined::figures() const {
	GroundFigures sum;
	for (const Part &part : parts_) {
		const GroundFigures figures = part.ground->figures();
		sum.checks += figures.checks;
		sum.reads += figures.reads;
	}
	return sum;
}

Status ScatterGroundCombined::sample_for(const GroundHost &host, std::span<const glm::dvec2> positions,
		const GroundNeeds &needs, std::span<Ground> r_ground) {
	std::ranges::fill(r_ground, Ground{});
	Status status;
	for_each_part([&](const Part &part) {
		if (!status.ok()) {
			return;
		}
		std::vector<Ground> ground(positions.size());
		status = part.ground->is_main_thread_only() ? part.ground->sample_now(host.id, positions, needs, ground)
													: sample_snapshot(part.ground, host, [&](const Terrain &terrain) {
														  return terrain.query(positions, needs, ground);
													  });
		for (std::size_t i = 0; i < ground.size() && status.ok(); ++i) {
			CombinedTerrain::raise(ground[i], r_ground[i]);
		}
	});
	return status;
}

/// The height is unknown where the height of any part is unknown.
Status ScatterGroundCombined::recheck_for(
		const GroundHost &host, std::span<const glm::dvec2> positions, std::span<std::optional<float>> r_heights) {
	constexpr float no_ground = std::numeric_limits<float>::quiet_NaN();
	std::ranges::fill(r_heights, no_ground);
	Status status;
	for_each_part([&](const Part &part) {
		if (!status.ok()) {
			return;
		}
		std::vector<std::optional<float>> heights(positions.size(), no_ground);
		if (part.ground->is_main_thread_only()) {
			status = part.ground->recheck_now(host.id, positions, heights);
		} else {
			status = sample_snapshot(part.ground, host, [&](const Terrain &terrain) {
				std::vector<Ground> ground(positions.size());
				const Status sample_status = terrain.sample_heights(positions, ground);
				std::ranges::transform(ground, heights.begin(), &Ground::height);
				return sample_status;
			});
		}
		for (std::size_t i = 0; i < heights.size() && status.ok(); ++i) {
			const bool is_known = heights[i].has_value() && r_heights[i].has_value();
			if (!is_known) {
				r_heights[i] = std::nullopt;
			} else if (std::isnan(*r_heights[i]) || *heights[i] > *r_heights[i]) {
				r_heights[i] = heights[i];
			}
		}
	});
	return status;
}

} // namespace thicket
