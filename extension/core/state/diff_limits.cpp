#include "core/state/diff_limits.hpp"

#include <limits>

namespace thicket {

namespace {

// Each refusal is recognized by its remedy.
constexpr const char *raise_limit = "Refuse the sender, or raise that limit in diff_limits";
constexpr const char *claim_first =
		"Assign the state to a TerrainScatter3D with that layer first, or clear the area of diff_limits";
constexpr const char *ask_for_earlier =
		"Ask its sender for diff_since() of the revision that get_missing_since() returns for this diff";

} // namespace

DiffLimits DiffLimits::none() {
	constexpr std::uint64_t any = std::numeric_limits<std::uint64_t>::max();
	DiffLimits limits;
	limits.max_changes = limits.max_total_changes = limits.max_added = any;
	return limits;
}

Status check_limit(const char *what, std::uint64_t value, std::uint64_t most, const char *limit) {
	return value <= most ? Status() : Status::out_of_range(what, value, at_most(most, limit), raise_limit);
}

Status refused_replacement() {
	return Status::out_of_range("replaces_everything", 1, exactly(0, "allow_replacement of diff_limits"), raise_limit);
}

Status check_area(const DiffLimits &limits, const Rect &place) {
	if (limits.area.empty() || meet(limits.area, place)) {
		return {};
	}
	const Rect &area = limits.area;
	const bool beside = place.max.x < area.min.x || place.min.x > area.max.x;
	const glm::dvec2 center = place.center();
	constexpr const char *note = "area of diff_limits";
	return beside ? Status::out_of_range("x", center.x, between(area.min.x, area.max.x, note), raise_limit)
				  : Status::out_of_range("z", center.y, between(area.min.y, area.max.y, note), raise_limit);
}

Status unknown_cells(std::uint16_t layer) {
	Status status = Status::missing("the position of points of a layer", claim_first);
	status.value = layer;
	return status;
}

Status missing_before(std::uint64_t base, std::uint64_t known) {
	return Status::out_of_range(
			"base_revision", base, at_most(known, "the last one known of its sender"), ask_for_earlier);
}

bool is_beyond_limits(const Status &status) { return status.remedy == raise_limit || status.remedy == claim_first; }

bool is_missing_earlier(const Status &status) { return status.remedy == ask_for_earlier; }

} // namespace thicket
