#include "tests/cost/growth.hpp"

#include "core/state/instance_state.hpp"
#include "core/state/pending_diff.hpp"
#include "core/state/state_changes.hpp"

#include <array>
#include <memory>

namespace thicket::cost {

namespace {

using Changes = std::vector<InstanceChange>;
using Stored = std::vector<std::uint8_t>;

AddedInstance instance_at(glm::dvec2 position) {
	AddedInstance instance;
	instance.position = {position.x, 0.0, position.y};
	return instance;
}

std::vector<AddedInstance> instances(const Recipe &recipe, std::size_t count) {
	std::vector<AddedInstance> result;
	for (const glm::dvec2 &position : recipe.points(count)) {
		result.push_back(instance_at(position));
	}
	return result;
}

InstanceState felled(const Recipe &recipe, std::size_t count, double return_time = 0.0) {
	InstanceState state;
	for (const std::uint64_t id : recipe.ids(count)) {
		need(state.remove(id, return_time).status);
	}
	return state;
}

InstanceState planted(const Recipe &recipe, std::size_t count) {
	InstanceState state;
	std::vector<std::uint64_t> ids;
	Changes changes;
	need(state.add_all(instances(recipe, count), ids, changes));
	return state;
}

Stored diff_of(const InstanceState &state) {
	Stored bytes;
	need(state.diff_since(0, bytes));
	return bytes;
}

std::uint64_t place_all(const Recipe &recipe, std::size_t count) {
	const std::vector<AddedInstance> all = instances(recipe, count);
	InstanceState state;
	std::vector<std::uint64_t> ids;
	Changes changes;
	return steps_of([&] { need(state.add_all(all, ids, changes)); });
}

std::uint64_t place_each(const Recipe &recipe, std::size_t count) {
	const std::vector<AddedInstance> all = instances(recipe, count);
	InstanceState state;
	std::uint64_t id = 0;
	return steps_of([&] {
		for (const AddedInstance &instance : all) {
			need(state.add(instance, id));
		}
	});
}

std::uint64_t take_away_and_place_again(const Recipe &recipe, std::size_t count) {
	InstanceState state = planted(recipe, count);
	const std::vector<AddedInstance> all = instances(recipe, count);
	const std::vector<std::uint64_t> ids = state.added_ids();
	std::uint64_t id = 0;
	return steps_of([&] {
		for (std::size_t i = 0; i < count; ++i) {
			need(state.remove(ids[i]).status);
			need(state.add(all[i], id));
		}
	});
}

std::uint64_t move_each(const Recipe &recipe, std::size_t count) {
	InstanceState state = planted(recipe, count);
	const Points to = recipe.points(2 * count);
	const std::vector<std::uint64_t> ids = state.added_ids();
	Changes changes;
	return steps_of([&] {
		for (std::size_t i = 0; i < count; ++i) {
			std::uint64_t id = 0;
			need(state.move(ids[i], instance_at(to[2 * count - 1 - i]), id, changes));
		}
	});
}

std::uint64_t remove_each(const Recipe &recipe, std::size_t count) {
	return steps_of([&] { felled(recipe, count); });
}

std::uint64_t remove_and_restore(const Recipe &recipe, std::size_t count) {
	InstanceState state;
	const std::vector<std::uint64_t> ids = recipe.ids(count);
	return steps_of([&] {
		for (std::size_t i = 0; i < count; ++i) {
			need(state.remove(ids[i % ids.size()]).status);
			need(state.restore(ids[i % ids.size()]).status);
		}
	});
}

std::uint64_t grow_at_once(const Recipe &recipe, std::size_t count) {
	InstanceState state = felled(recipe, count, 10.0);
	Changes changes;
	return steps_of([&] { need(state.advance(20.0, changes)); });
}

std::uint64_t grow_one_by_one(const Recipe &recipe, std::size_t count) {
	InstanceState state;
	double return_time = 0.0;
	const std::vector<std::uint64_t> ids = recipe.ids(count);
	for (const std::uint64_t id : ids) {
		need(state.remove(id, return_time += 1.0).status);
	}
	Changes changes;
	return steps_of([&] {
		for (std::size_t i = 0; i < ids.size(); ++i) {
			need(state.advance(1.0, changes));
		}
	});
}

std::uint64_t postpone(const Recipe &recipe, std::size_t count) {
	InstanceState state;
	const std::vector<std::uint64_t> ids = recipe.ids(count);
	double return_time = 1.0;
	return steps_of([&] {
		for (std::size_t i = 0; i < 4 * count; ++i) {
			need(state.remove(ids[i % ids.size()], return_time += 1.0).status);
		}
	});
}

std::uint64_t write_data(const Recipe &recipe, std::size_t count) {
	InstanceState state;
	const Stored data(24, 7);
	return steps_of([&] {
		for (const std::uint64_t id : recipe.ids(count)) {
			need(state.set_data(id, data));
		}
		Stored bytes;
		need(state.save(bytes));
	});
}

std::uint64_t save_and_load(const Recipe &recipe, std::size_t count) {
	const InstanceState state = felled(recipe, count, 5.0);
	return steps_of([&] {
		Stored bytes;
		need(state.save(bytes));
		InstanceState other;
		Changes changes;
		need(other.load(bytes, changes));
	});
}

std::uint64_t apply_diffs(const Recipe &recipe, std::size_t count) {
	const Stored removals = diff_of(felled(recipe, count));
	const Stored added_bytes = diff_of(planted(recipe, count));
	InstanceState state;
	Changes changes;
	return steps_of([&] {
		need(state.apply(removals, changes));
		need(state.apply(added_bytes, changes));
	});
}

std::uint64_t send_each_change(const Recipe &recipe, std::size_t count) {
	InstanceState state;
	const std::vector<std::uint64_t> ids = recipe.ids(count);
	InstanceState peer;
	Changes changes;
	return steps_of([&] {
		for (const std::uint64_t id : ids) {
			const std::uint64_t before = state.revision();
			need(state.remove(id).status);
			Stored bytes;
			need(state.diff_since(before, bytes));
			need(peer.apply(bytes, changes));
		}
	});
}

std::uint64_t take_back(const Recipe &recipe, std::size_t count) {
	InstanceState state = planted(recipe, count);
	const std::vector<std::uint64_t> ids = state.added_ids();
	Stored step;
	Changes changes;
	return steps_of([&] {
		need(state.diff_of(ids, step));
		for (const std::uint64_t id : ids) {
			need(state.remove(id).status);
		}
		need(state.apply(step, changes));
	});
}

std::uint64_t merge_two(const Recipe &recipe, std::size_t count) {
	InstanceState state = felled(recipe, count);
	const InstanceState other = planted(recipe, count);
	Changes changes;
	return steps_of([&] { need(state.merge(other, changes)); });
}

std::uint64_t work_beside_a_diff(const Recipe &recipe, std::size_t count) {
	InstanceState state = felled(recipe, count);
	const Stored bytes = diff_of(planted(recipe, count));
	const std::vector<std::uint64_t> ids = recipe.ids(count);
	return steps_of([&] {
		std::shared_ptr<PendingDiff> pending;
		need(state.queue_diff(bytes, pending));
		for (const std::uint64_t id : ids) {
			need(state.restore(id).status);
		}
		pending->work();
		StateChanges changes;
		need(state.finish_pending_diff(changes));
	});
}

std::uint64_t queue_many_diffs(const Recipe &recipe, std::size_t count) {
	constexpr std::size_t divisor = 8; // One diff takes many steps.
	std::vector<Stored> diffs;
	InstanceState other;
	for (const std::uint64_t id : recipe.ids(count / divisor)) {
		const std::uint64_t before = other.revision();
		need(other.remove(id).status);
		need(other.diff_since(before, diffs.emplace_back()));
	}
	InstanceState state;
	return steps_of([&] {
		std::vector<std::shared_ptr<PendingDiff>> pending(diffs.size());
		for (std::size_t i = 0; i < diffs.size(); ++i) {
			need(state.queue_diff(diffs[i], pending[i]));
		}
		for (const std::shared_ptr<PendingDiff> &diff : pending) {
			diff->work();
			StateChanges changes;
			need(state.finish_pending_diff(changes));
		}
	});
}

constexpr std::array cases = {
		Case{"state: place all", place_all},
		Case{"state: place each", place_each},
		Case{"state: delete placed, place again", take_away_and_place_again},
		Case{"state: move each", move_each},
		Case{"state: remove each", remove_each},
		Case{"state: remove and restore", remove_and_restore},
		Case{"state: all grow back simultaneously", grow_at_once},
		Case{"state: grow back one by one", grow_one_by_one},
		Case{"state: regrowth is postponed", postpone},
		Case{"state: data of each", write_data},
		Case{"state: save and load", save_and_load},
		Case{"state: apply diffs", apply_diffs},
		Case{"state: send each change", send_each_change},
		Case{"state: undo", take_back},
		Case{"state: merge", merge_two},
		Case{"state: changes while a diff is applied", work_beside_a_diff},
		Case{"state: many pending diffs", queue_many_diffs},
};

} // namespace

std::span<const Case> cases_of_states() { return cases; }

} // namespace thicket::cost
