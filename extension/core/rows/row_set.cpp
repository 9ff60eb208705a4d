#include "core/rows/row_set.hpp"

#include "core/base/bvh_order.hpp"
#include "core/base/check.hpp"
#include "core/base/guard.hpp"
#include "core/base/instance_id.hpp"
#include "core/rows/row_numbers.hpp"
#include "core/rules/instance_random.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

namespace thicket {

namespace {

/// On the inner side of a bend, a row may come this much nearer to its line than its offset. Points that
/// are even nearer are left out, because they stand in front of other points.
constexpr double nearest_part = 0.9;

/// Assumed distance between lines, in meters, for estimates.
constexpr double usual_line_distance = 5.0;

constexpr std::uint64_t bits(std::uint64_t value, int first, int count) {
	return value >> first & ((std::uint64_t{1} << count) - 1);
}

} // namespace

Status validate(const RowSettings &settings) {
	Status status = first_failure(check_range("step", settings.step, min_row_step, max_row_step),
			check_range("row_distance", settings.row_distance, min_row_step, max_row_step),
			check_range("row_angle_degrees", settings.row_angle_degrees, -360.0, 360.0),
			check_range("jitter_along", settings.jitter_along, 0.0, max_row_jitter),
			check_range("jitter_across", settings.jitter_across, 0.0, max_row_jitter),
			check_range("crossing_gap", settings.crossing_gap, 0.0, max_crossing_gap));
	if (status.ok() && settings.offsets.size() > max_row_offsets) {
		status = Status::wrong_size("offsets", settings.offsets.size(), at_most(max_row_offsets, "entries"));
	}
	for (std::size_t i = 0; status.ok() && i < settings.offsets.size(); ++i) {
		status = check_range("offsets", settings.offsets[i], -max_row_offset, max_row_offset);
	}
	return status;
}

double equivalent_radius(const RowSettings &settings) {
	const double across = settings.fills_areas ? settings.row_distance : std::max(settings.step, usual_line_distance);
	// The density of a set is inversely proportional to the square of its radius.
	return std::clamp(std::sqrt(point_density({.radius = 1.0}) * settings.step * across), min_radius, max_radius);
}

double RowSet::reach() const {
	const double displacement = settings_.jitter_along + settings_.jitter_across;
	double offset = 0.0;
	for (const double each : settings_.offsets) {
		offset = std::max(offset, std::abs(each));
	}
	return settings_.fills_areas ? displacement : displacement + offset;
}

Status RowSet::set(const RowSettings &settings, std::vector<RowLine> lines) {
	return guarded("rows.paths", static_cast<double>(lines.size()), [&] {
		std::vector<SharedRowLine> shared;
		for (RowLine &line : lines) {
			shared.push_back(std::make_shared<const RowLine>(std::move(line)));
		}
		return set_shared(settings, std::move(shared));
	});
}

Status RowSet::set_shared(const RowSettings &settings, std::vector<SharedRowLine> lines, const RowSet *former) {
	Status status = validate(settings);
	if (status.ok() && lines.size() > max_row_lines) {
		status = Status::wrong_size("rows.paths", lines.size(), at_most(max_row_lines, "paths"), "Use fewer paths");
	}
	if (!status.ok()) {
		return status;
	}
	const RowSet *similar = former != nullptr && former->settings_ == settings ? former : nullptr;
	return guarded("rows.paths", static_cast<double>(lines.size()), [&] {
		RowSet next;
		next.settings_ = settings;
		if (const Status added = next.add_courses(lines, similar); !added.ok()) {
			return added;
		}
		next.assign_keys(similar);
		next.index_courses();
		if (settings.crossing_gap > 0.0 && !settings.fills_areas) {
			next.find_crossings(similar);
		}
		*this = std::move(next);
		return Status();
	});
}

/// Computes the courses of the lines that `former` does not have.
Status RowSet::add_courses(const std::vector<SharedRowLine> &lines, const RowSet *former) {
	courses_.reserve(lines.size());
	for (std::size_t i = 0; i < lines.size(); ++i) {
		if (const SharedRowCourse *known = former != nullptr ? former->find_course(lines[i], i) : nullptr) {
			courses_.push_back(*known);
			continue;
		}
		auto course = std::make_shared<RowCourse>();
		if (const Status status = course->set(settings_, lines[i]); !status.ok()) {
			return status;
		}
		courses_.push_back(std::move(course));
	}
	return {};
}

/// Returns the course of an equal line, which is probably at `index`; null if there is none.
const SharedRowCourse *RowSet::find_course(const SharedRowLine &line, std::size_t index) const {
	if (index < courses_.size() && courses_[index]->line() == line) {
		return &courses_[index];
	}
	const auto identity_of = [this](std::uint32_t index) {
		return courses_[index]->line()->identity;
	};
	for (auto at = std::ranges::lower_bound(by_identity_, line->identity, {}, identity_of);
			at != by_identity_.end() && identity_of(*at) == line->identity; ++at) {
		const SharedRowLine &known = courses_[*at]->line();
		if (known == line || *known == *line) {
			return &courses_[*at];
		}
	}
	return nullptr;
}

/// Assigns each line its number in IDs: the upper bits of its identity, or the next free number. Lines
/// with the same identities as in `former` have the same numbers.
void RowSet::assign_keys(const RowSet *former) {
	const auto same_identity = [](const SharedRowCourse &a, const SharedRowCourse &b) {
		return a == b || a->line()->identity == b->line()->identity;
	};
	if (former != nullptr && std::ranges::equal(courses_, former->courses_, same_identity)) {
		keys_ = former->keys_;
		by_key_ = former->by_key_;
		by_identity_ = former->by_identity_;
		return;
	}
	constexpr std::uint32_t key_count = 1U << row_line_bits;
	by_identity_.resize(courses_.size());
	std::iota(by_identity_.begin(), by_identity_.end(), 0U);
	std::ranges::stable_sort(by_identity_, {}, [this](std::uint32_t line) { return courses_[line]->line()->identity; });
	std::vector<bool> taken(key_count);
	keys_.resize(courses_.size());
	for (const std::uint32_t line : by_identity_) {
		auto key = static_cast<std::uint32_t>(courses_[line]->line()->identity >> (64 - row_line_bits));
		while (taken[key]) {
			key = (key + 1) % key_count;
		}
		taken[key] = true;
		keys_[line] = key;
	}
	by_key_ = by_identity_;
	std::ranges::sort(by_key_, {}, [this](std::uint32_t line) { return keys_[line]; });
}

/// Builds the tree of all lines that have rows.
void RowSet::index_courses() {
	std::vector<BvhKey> order;
	for (std::uint32_t line = 0; line < courses_.size(); ++line) {
		if (!courses_[line]->empty()) {
			const Rect &bounds = courses_[line]->bounds();
			order.push_back({0.5 * (bounds.min + bounds.max), line});
		}
	}
	put_in_order(Bvh(order.size()), order);
	std::vector<std::uint32_t> lines;
	std::vector<Rect> bounds;
	for (const BvhKey &key : order) {
		lines.push_back(key.item);
		bounds.push_back(courses_[key.item]->bounds());
	}
	tree_.set(std::move(lines), bounds);
}

/// Finds the positions at which lines cross. Takes those of two unchanged lines from `former`.
void RowSet::find_crossings(const RowSet *former) {
	std::vector<bool> known(courses_.size());
	if (former != nullptr) {
		add_former_crossings(*former, known);
	}
	for (std::uint32_t line = 0; line < courses_.size(); ++line) {
		if (known[line] || courses_[line]->empty()) {
			continue;
		}
		tree_.visit(expanded(courses_[line]->bounds(), settings_.crossing_gap), [&](std::uint32_t other) {
			// Two changed lines find each other, so only one of them adds the crossings.
			if (known[other] || other >= line) {
				add_crossings(line, other);
			}
		});
	}
	std::vector<glm::dvec2> positions;
	for (const Crossing &crossing : crossings_of_lines_) {
		positions.push_back(crossing.position);
	}
	crossings_.set(std::move(positions));
}

/// Copies the crossings of lines of `former` that this set has, too. Sets `r_known` to true for these
/// lines.
void RowSet::add_former_crossings(const RowSet &former, std::vector<bool> &r_known) {
	std::map<const RowCourse *, std::uint32_t> index_of; // Of the lines whose index may have changed.
	for (std::uint32_t line = 0; line < courses_.size(); ++line) {
		if (line >= former.courses_.size() || courses_[line] != former.courses_[line]) {
			index_of.emplace(courses_[line].get(), line);
		}
	}
	std::vector<std::uint32_t> now(former.courses_.size(), max_row_lines);
	for (std::uint32_t line = 0; line < now.size(); ++line) {
		if (line < courses_.size() && courses_[line] == former.courses_[line]) {
			now[line] = line;
		} else if (const auto found = index_of.find(former.courses_[line].get()); found != index_of.end()) {
			now[line] = found->second;
		}
		if (now[line] < max_row_lines) {
			r_known[now[line]] = true;
		}
	}
	for (const Crossing &crossing : former.crossings_of_lines_) {
		if (now[crossing.a] < max_row_lines && now[crossing.b] < max_row_lines) {
			crossings_of_lines_.push_back({now[crossing.a], now[crossing.b], crossing.position});
		}
	}
}

/// Adds the crossings of two lines, or those of a line with itself. The order of the arguments has no
/// effect on the bits of the positions.
void RowSet::add_crossings(std::uint32_t one, std::uint32_t other) {
	const auto order_of = [this](std::uint32_t line) {
		return std::pair(courses_[line]->line()->identity, line);
	};
	const bool is_ordered = order_of(one) <= order_of(other);
	const std::uint32_t a = is_ordered ? one : other;
	const std::uint32_t b = is_ordered ? other : one;
	const RowCourse &first = *courses_[a];
	const RowCourse &second = *courses_[b];
	// Open ends reach as far as the gap. See crossing_of.
	const double extension = settings_.crossing_gap;
	first.visit_segments(expanded(second.bounds(), extension), [&](std::uint32_t segment) {
		const RowSegment ends = first.ends_of(segment);
		second.visit_segments(expanded(first.box_of(segment), extension), [&](std::uint32_t crossed) {
			if (a == b && (crossed <= segment || first.are_consecutive(segment, crossed))) {
				return;
			}
			if (const auto crossing = crossing_of(ends, second.ends_of(crossed), extension)) {
				crossings_of_lines_.push_back({a, b, *crossing});
			}
		});
	});
}

std::uint64_t RowSet::id_of(const PointSet &set, const Place &place) const {
	const std::uint64_t key = keys_[place.line];
	const std::int64_t row = place.row + (settings_.fills_areas ? middle_row : 0);
	const std::int64_t step = place.step + (settings_.fills_areas ? middle_step : 0);
	return std::uint64_t{set.layer} << id_layer_shift |
			(key >> low_row_line_bits) << (row_number_bits + low_row_line_bits + row_step_bits) |
			static_cast<std::uint64_t>(row) << (low_row_line_bits + row_step_bits) |
			bits(key, 0, low_row_line_bits) << row_step_bits | static_cast<std::uint64_t>(step);
}

/// Returns the place in an ID, if it may be that of a point.
std::optional<RowSet::Place> RowSet::place_of(std::uint64_t id) const {
	const std::uint64_t key =
			bits(id, row_number_bits + low_row_line_bits + row_step_bits, row_line_bits - low_row_line_bits)
					<< low_row_line_bits |
			bits(id, row_step_bits, low_row_line_bits);
	const auto found = std::ranges::lower_bound(by_key_, key, {}, [this](std::uint32_t line) { return keys_[line]; });
	if (found == by_key_.end() || keys_[*found] != key || courses_[*found]->empty()) {
		return std::nullopt;
	}
	Place place{*found, static_cast<std::int64_t>(bits(id, low_row_line_bits + row_step_bits, row_number_bits)),
			static_cast<std::int64_t>(bits(id, 0, row_step_bits))};
	if (settings_.fills_areas) {
		place.row -= middle_row;
		place.step -= middle_step;
		return place;
	}
	const bool exists = static_cast<std::size_t>(place.row) < settings_.offsets.size() &&
			place.step < courses_[place.line]->count();
	return exists ? std::optional(place) : std::nullopt;
}

/// Returns the position of a point after its random displacement.
glm::dvec2 RowSet::displaced(const PointSet &set, std::uint64_t id, const Spot &spot) const {
	if (settings_.jitter_along == 0.0 && settings_.jitter_across == 0.0) {
		return spot.position;
	}
	const auto random = instance_random(set.seed, id, Draw::row);
	const double along = settings_.jitter_along * (2.0 * unit_interval(random[1]) - 1.0);
	const double across = settings_.jitter_across * (2.0 * unit_interval(random[2]) - 1.0);
	return spot.position + spot.direction * along + right_of(spot.direction) * across;
}

/// Returns the position of a place along a line, unless the rules of rows leave it out. `segment` is the
/// result of segment_at.
std::optional<glm::dvec2> RowSet::position_of(
		const PointSet &set, const Place &place, std::size_t segment, std::uint64_t id) const {
	const RowCourse &course = *courses_[place.line];
	const double offset = settings_.offsets[static_cast<std::size_t>(place.row)];
	Spot spot = course.spot_at(segment, along(place.step));
	spot.position += right_of(spot.direction) * offset;
	const double least = nearest_part * std::abs(offset);
	if (offset != 0.0 && course.outline().distance(spot.position, least) < least) {
		return std::nullopt;
	}
	const glm::dvec2 position = displaced(set, id, spot);
	if (settings_.crossing_gap > 0.0 && crossings_.is_near(position, settings_.crossing_gap)) {
		return std::nullopt;
	}
	return position;
}

/// Returns the position of a place in an area, if the area contains it.
std::optional<glm::dvec2> RowSet::position_in_area(const PointSet &set, const Place &place, std::uint64_t id) const {
	const RowCourse &course = *courses_[place.line];
	const glm::dvec2 right = right_of(course.direction());
	const Spot spot{course.line()->anchor + course.direction() * along(place.step) +
					right * (static_cast<double>(place.row) * settings_.row_distance),
			course.direction()};
	return course.outline().contains(spot.position) ? std::optional(displaced(set, id, spot)) : std::nullopt;
}

std::optional<glm::dvec2> RowSet::position(const PointSet &set, std::uint64_t id) const {
	const std::optional<Place> place = place_of(id);
	if (!place) {
		return std::nullopt;
	}
	return settings_.fills_areas ? position_in_area(set, *place, id)
								 : position_of(set, *place, courses_[place->line]->segment_at(along(place->step)), id);
}

Rotation RowSet::heading(std::uint64_t id) const {
	const std::optional<Place> place = place_of(id);
	if (!place) {
		return {};
	}
	const RowCourse &course = *courses_[place->line];
	const double distance = along(place->step);
	const glm::dvec2 direction = settings_.fills_areas
			? course.direction()
			: course.spot_at(course.segment_at(distance), distance).direction;
	return {-direction.y, -direction.x};
}

} // namespace thicket
