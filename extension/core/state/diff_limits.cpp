#include "core/state/diff_limits.hpp"

#include <limits>

namespace thicket {

namespace {

constexpr const char *raise_limit = "Reject the diff, or relax that limit in diff_limits";
constexpr const char *claim_first =
		"Assign the state to a TerrainScatter3D with that layer first, or clear the area of diff_limits";
constexpr const char *ask_for_earlier =
		"Request diff_since() from its sender, for the revision that get_missing_since() returns for this diff";

template <class Number>
Status not_allowed(const char *what, Number value, const AllowedRange &allowed) {
	Status status = Status::out_of_range(what, value, allowed, raise_limit);
	status.code = ErrorCode::not_allowed;
	return status;
}

} // namespace

DiffLimits DiffLimits::none() {
	constexpr std::uint64_t any = std::numeric_limits<std::uint64_t>::max();
	DiffLimits limits;
	limits.max_changes = limits.max_total_changes = limits.max_added = any;
	return limits;
}

Status check_limit(const char *what, std::uint64_t value, std::uint64_t max_value, const char *limit) {
	return value <= max_value ? Status() : not_allowed(what, value, at_most(max_value, limit));
}

Status refused_replacement() {
	return not_allowed("replaces_everything", 1, exactly(0, "allow_replacement of diff_limits"));
}

Status check_area(const DiffLimits &limits, const Rect &changed) {
	if (limits.area.empty() || meet(limits.area, changed)) {
		return {};
	}
	const Rect &area = limits.area;
	const bool is_beside = changed.max.x < area.min.x || changed.min.x > area.max.x;
	const glm::dvec2 center = changed.center();
	constexpr const char *note = "area of diff_limits";
	return is_beside ? not_allowed("x", center.x, between(area.min.x, area.max.x, note))
					 : not_allowed("z", center.y, between(area.min.y, area.max.y, note));
}

Status unknown_cells(std::uint16_t layer) {
	return {ErrorCode::not_allowed, "the position of points of a layer", static_cast<double>(layer), {}, {},
			claim_first};
}

Status missing_before(std::uint64_t base, std::uint64_t known) {
	Status status = Status::out_of_range(
			"base_revision", base, at_most(known, "the last revision received from its sender"), ask_for_earlier);
	status.code = ErrorCode::out_of_order;
	return status;
}

} // namespace thicket
