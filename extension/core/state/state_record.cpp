#include "core/state/state_record.hpp"

#include "core/base/check.hpp"
#include "core/state/added_numbers.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace thicket {

namespace {

bool are_points(const StateRecord::Codes &codes) { return codes.empty() || !is_added(codes.back()); }

bool are_added(const StateRecord::Codes &codes) { return codes.empty() || is_added(codes.front()); }

/// Returns true if each code in `part` occurs in one of `lists`.
bool covers(const std::array<const StateRecord::Codes *, 3> &lists, const StateRecord::Codes &part) {
	return std::ranges::all_of(part, [&lists](std::uint64_t code) {
		return std::ranges::any_of(
				lists, [code](const StateRecord::Codes *list) { return std::ranges::binary_search(*list, code); });
	});
}

bool disjoint(const StateRecord::Codes &left, const StateRecord::Codes &right) {
	return std::ranges::none_of(left, [&right](std::uint64_t code) { return std::ranges::binary_search(right, code); });
}

} // namespace

Status validate(const AddedInstance &instance) {
	if (instance.layer > max_state_layer) {
		return Status::out_of_range("layer", instance.layer, at_most(max_state_layer));
	}
	for (int axis = 0; axis < 3; ++axis) {
		if (const Status status =
						check_range("position", instance.position[axis], -max_added_coordinate, max_added_coordinate);
				!status.ok()) {
			return status;
		}
	}
	for (int column = 0; column < 3; ++column) {
		for (int row = 0; row < 3; ++row) {
			if (const double number = instance.basis[column][row]; !std::isfinite(number)) {
				return {ErrorCode::not_finite, "basis", number};
			}
		}
	}
	return {};
}

AddedInstance without_signed_zeros(AddedInstance instance) {
	for_each_number(instance, [](auto &r_number) {
		if (r_number == 0) {
			r_number = 0;
		}
	});
	return instance;
}

std::map<std::uint16_t, std::uint64_t> StateRecord::layers() const {
	std::map<std::uint16_t, std::uint64_t> found;
	for (const Codes *codes : {&removed, &present, &removed_placed, &added}) {
		int last = -1;
		for (const std::uint64_t code : *codes) {
			if (layer_of(code) != last) {
				last = layer_of(code);
				found.emplace(layer_of(code), 0);
			}
		}
	}
	return found;
}

bool StateRecord::has_points(std::uint16_t layer) const {
	return std::ranges::any_of(std::array{&removed, &present}, [layer](const Codes *codes) {
		const auto first = std::ranges::lower_bound(*codes, layer, {}, layer_of);
		return first != codes->end() && layer_of(*first) == layer;
	});
}

bool StateRecord::contains(std::uint64_t id) const {
	const std::uint64_t code = code_of(id);
	return std::ranges::any_of(std::array{&removed, &present, &removed_placed, &added},
			[code](const Codes *codes) { return std::ranges::binary_search(*codes, code); });
}

void StateRecord::add_data(std::uint64_t code, Entry &r_entry) const {
	const auto found = std::ranges::lower_bound(with_data, code);
	if (found != with_data.end() && *found == code) {
		const auto at = static_cast<std::size_t>(found - with_data.begin());
		r_entry.data = data[at];
		r_entry.data_at = data_at[at];
	}
}

bool is_less(const AddedInstance &left, const AddedInstance &right) {
	if (left.mesh != right.mesh) {
		return left.mesh < right.mesh;
	}
	std::array<double, 12> numbers{};
	std::size_t at = 0;
	for_each_number(left, [&](auto number) { numbers[at++] = static_cast<double>(number); });
	at = 0;
	int order = 0;
	for_each_number(right, [&](auto number) {
		const double mine = numbers[at++];
		const auto theirs = static_cast<double>(number);
		order = order != 0 || mine == theirs ? order : mine < theirs ? -1 : 1;
	});
	return order < 0;
}

bool is_consistent(const StateRecord &record) {
	const bool kinds = are_points(record.removed) && are_points(record.present) && are_added(record.removed_placed) &&
			are_added(record.added);
	const bool once = disjoint(record.present, record.removed) && disjoint(record.removed_placed, record.added);
	const bool no_more_than_complete = !record.is_complete ||
			(record.removed_placed.empty() &&
					covers({&record.with_data, &record.with_data, &record.with_data}, record.present));
	const bool stamped = std::ranges::equal(
			record.layers(), record.stamps, {}, [](const auto &a) { return a.first; },
			[](const auto &b) { return b.first; });
	return kinds && once && no_more_than_complete && stamped &&
			covers({&record.removed, &record.present, &record.added}, record.with_data);
}

} // namespace thicket
