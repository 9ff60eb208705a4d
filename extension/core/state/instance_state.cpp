#include "core/state/instance_state.hpp"

#include "core/base/guard.hpp"
#include "core/base/split_mix.hpp"
#include "core/base/word_hash.hpp"
#include "core/state/free_id.hpp"
#include "core/state/instance_state_content.hpp"
#include "core/state/state_step.hpp"

#include <algorithm>

namespace thicket {

namespace {

using Kind = StateStep::Kind;

constexpr std::uint64_t added_bit = std::uint64_t{1} << 63;

/// Returns 48 bits that depend on every field of an instance.
std::uint64_t hash_of(const AddedInstance &instance) {
	WordHash hash;
	hash.add(std::uint32_t{instance.mesh});
	for (int axis = 0; axis < 3; ++axis) {
		hash.add(instance.position[axis]);
	}
	for (int column = 0; column < 3; ++column) {
		for (int row = 0; row < 3; ++row) {
			hash.add(instance.basis[column][row]);
		}
	}
	return split_mix(hash.value()) & id_cell_mask;
}

/// Returns the ID for a new instance, whose zeros must be unsigned.
template <typename Taken>
std::uint64_t id_for(const AddedInstance &placed, const Taken &taken) {
	return free_id(added_bit | std::uint64_t{placed.layer} << id_layer_shift, hash_of(placed), taken);
}

bool is_of(std::uint64_t id, int layer) { return layer < 0 || layer_of(id) == layer; }

/// Returns the IDs of one layer, or of all layers if `layer` is negative, in ascending order.
template <typename Table>
std::vector<std::uint64_t> ids_of_layer(const Table &table, int layer) {
	std::vector<std::uint64_t> ids;
	table.for_each([&ids, layer](std::uint64_t id, const auto &) {
		if (is_of(id, layer)) {
			ids.push_back(id);
		}
	});
	std::ranges::sort(ids);
	return ids;
}

StateStep step_of(std::uint64_t id, const AddedInstance &placed) {
	return {.kind = Kind::place, .id = id, .instance = std::make_shared<const AddedInstance>(placed)};
}

} // namespace

std::uint64_t stamp_of(const PointSet &set) {
	WordHash hash;
	hash.add(set.seed);
	hash.add(set.radius);
	hash.add(set.levels);
	if (set.on_surface) {
		// Sets on the plane add no word, so that they keep the stamps of earlier releases.
		hash.add(std::uint32_t{1});
	}
	if (set.in_rows) {
		hash.add(std::uint32_t{2});
	}
	const std::uint64_t stamp = split_mix(hash.value());
	return stamp != 0 ? stamp : 1;
}

InstanceState::InstanceState() : content_(std::make_unique<Content>()) {}
InstanceState::~InstanceState() = default;
InstanceState::InstanceState(InstanceState &&) noexcept = default;
InstanceState &InstanceState::operator=(InstanceState &&) noexcept = default;

bool InstanceState::removed(std::uint64_t id) const {
	if (!any_removed(layer_of(id))) {
		// No point of this layer is removed.
		return false;
	}
	return content_->removed.contains(id);
}

const AddedInstance *InstanceState::added(std::uint64_t id) const { return content_->instance_of(id); }

std::span<const std::uint8_t> InstanceState::data(std::uint64_t id) const { return content_->bytes_of(id); }

Status InstanceState::added_in(std::uint16_t layer, const Rect &rect, std::vector<std::uint64_t> &r_ids) const {
	if (rect.empty()) {
		return {};
	}
	constexpr double beyond_all = 2.0 * max_added_coordinate;
	const Rect finite{glm::clamp(rect.min, -beyond_all, beyond_all), glm::clamp(rect.max, -beyond_all, beyond_all)};
	const std::size_t first = r_ids.size();
	const Status status = guarded("rect", std::max(rect.size().x, rect.size().y), [&] {
		content_->grid.for_each_near(layer, finite, [&](std::uint64_t id) {
			const glm::dvec3 position = content_->added.value(id)->instance.position;
			if (rect.contains({position.x, position.z})) {
				r_ids.push_back(id);
			}
		});
	});
	r_ids.resize(status.ok() ? r_ids.size() : first);
	std::sort(r_ids.begin() + static_cast<std::ptrdiff_t>(first), r_ids.end());
	return status;
}

double InstanceState::max_added_scale(std::uint16_t layer) const {
	const auto layer_entry = content_->layers.find(layer);
	return layer_entry != content_->layers.end() ? layer_entry->second.max_scale : 0.0;
}

std::vector<std::uint64_t> InstanceState::removed_ids(int layer) const {
	return ids_of_layer(content_->removed, layer);
}
std::vector<std::uint64_t> InstanceState::added_ids(int layer) const { return ids_of_layer(content_->added, layer); }
std::vector<std::uint64_t> InstanceState::data_ids(int layer) const { return ids_of_layer(content_->data, layer); }

std::size_t InstanceState::removed_count() const { return content_->removed.size(); }
std::size_t InstanceState::added_count() const { return content_->added.size(); }
std::size_t InstanceState::data_count() const { return content_->data.size(); }

bool InstanceState::any_removed(std::uint16_t layer) const {
	const auto layer_entry = content_->layers.find(layer);
	return layer_entry != content_->layers.end() && layer_entry->second.removed > 0;
}

std::uint64_t InstanceState::revision() const { return content_->revision; }
double InstanceState::time() const { return content_->time; }
std::uint64_t InstanceState::origin() const { return content_->origin; }
void InstanceState::set_origin(std::uint64_t name) { content_->origin = name; }
std::uint64_t InstanceState::known_revision(std::uint64_t origin) const { return content_->known.of(origin); }

Status InstanceState::claim(std::uint16_t layer, std::uint64_t stamp, double cell_side, std::int32_t cells_together) {
	if (layer > max_state_layer) {
		return Status::out_of_range("layer", layer, at_most(max_state_layer));
	}
	if (const Status status = guarded("layer", layer, [&] { content_->layers.try_emplace(layer); }); !status.ok()) {
		return status;
	}
	Content::Layer &layer_entry = content_->layers[layer];
	if (layer_entry.is_foreign(stamp)) {
		return {ErrorCode::foreign, "layer", static_cast<double>(layer)};
	}
	const auto step = [&] {
		return StateStep{.kind = Kind::claim, .id = layer, .to = stamp, .number = cell_side, .count = cells_together};
	};
	return Journal::noting(journal_.get(), "layer", layer, step, [&] {
		layer_entry.stamp = stamp;
		layer_entry.claimed = true;
		layer_entry.cell_side = cell_side;
		layer_entry.cells_together = cells_together;
		return Status();
	});
}

void InstanceState::release_claims() {
	const auto step = [] {
		return StateStep{.kind = Kind::release_claims};
	};
	// If memory for the step runs out, the result of a pending diff keeps the claims. The only
	// effect is that some layers still reject other stamps.
	static_cast<void>(Journal::noting(journal_.get(), "layers", 0.0, step, [] { return Status(); }));
	for (auto &[number, layer] : content_->layers) {
		layer.claimed = false;
		layer.cell_side = 0.0;
	}
	std::erase_if(content_->layers, [](const auto &layer) { return !layer.second.has_entries(); });
}

std::uint64_t InstanceState::stamp(std::uint16_t layer) const {
	const auto layer_entry = content_->layers.find(layer);
	return layer_entry != content_->layers.end() ? layer_entry->second.stamp : 0;
}

bool InstanceState::is_foreign(std::uint16_t layer, std::uint64_t stamp) const {
	const auto layer_entry = content_->layers.find(layer);
	return layer_entry != content_->layers.end() && layer_entry->second.is_foreign(stamp);
}

StateChange InstanceState::remove(std::uint64_t id, double until) {
	Content::Entry target;
	if (!is_added(id)) {
		target = content_->entry(id);
		target.removed = true;
		target.until = until > 0.0 && until <= max_state_time ? until : 0.0;
	}
	const auto step = [&] {
		return StateStep{.kind = Kind::remove, .id = id, .number = until};
	};
	StateChange change;
	change.status = Journal::noting(journal_.get(), "id", static_cast<double>(id), step, [&] {
		change = content_->change_one(id, target, "id", static_cast<double>(id));
		return change.status;
	});
	return change;
}

StateChange InstanceState::restore(std::uint64_t id) {
	const auto step = [&] {
		return StateStep{.kind = Kind::restore, .id = id};
	};
	StateChange change;
	change.status = Journal::noting(journal_.get(), "id", static_cast<double>(id), step, [&] {
		if (removed(id)) {
			Content::Entry target = content_->entry(id);
			target.removed = false;
			change = content_->change_one(id, target, "id", static_cast<double>(id));
		}
		return change.status;
	});
	return change;
}

StateChange InstanceState::put(std::uint64_t id, const AddedInstance &instance) {
	return content_->change_one(id, content_->placed_as(id, instance), "instance", 1.0);
}

Status InstanceState::add(const AddedInstance &instance, std::uint64_t &r_id) {
	if (const Status status = validate(instance); !status.ok()) {
		return status;
	}
	const AddedInstance placed = without_signed_zeros(instance);
	const std::uint64_t id =
			id_for(placed, [this](std::uint64_t candidate) { return content_->added.contains(candidate); });
	const auto step = [&] {
		return step_of(id, placed);
	};
	const Status status =
			Journal::noting(journal_.get(), "instance", 1.0, step, [&] { return put(id, placed).status; });
	r_id = status.ok() ? id : r_id;
	return status;
}

Status InstanceState::add_all(std::span<const AddedInstance> instances, std::vector<std::uint64_t> &r_ids,
		std::vector<InstanceChange> &r_changes) {
	r_ids.clear();
	return guarded("instances", static_cast<double>(instances.size()), [&]() -> Status {
		std::vector<AddedInstance> normalized;
		IdTable<bool> new_ids;
		normalized.reserve(instances.size());
		new_ids.expect(instances.size());
		r_ids.reserve(instances.size());
		for (const AddedInstance &instance : instances) {
			if (const Status status = validate(instance); !status.ok()) {
				return status;
			}
			normalized.push_back(without_signed_zeros(instance));
			r_ids.push_back(id_for(normalized.back(), [&](std::uint64_t candidate) {
				return content_->added.contains(candidate) || new_ids.contains(candidate);
			}));
			new_ids.insert(r_ids.back());
		}
		Journal::Noting noting(journal_.get());
		for (std::size_t index = 0; index < normalized.size(); ++index) {
			noting.record([&] { return step_of(r_ids[index], normalized[index]); });
		}
		const auto visit_entries = [&](const auto &use) {
			for (std::size_t index = 0; index < normalized.size(); ++index) {
				use(r_ids[index], Content::Entry{.instance = &normalized[index], .placed_at = content_->time});
			}
		};
		content_->change_all(visit_entries, r_changes);
		noting.keep_if(true);
		return {};
	});
}

Status InstanceState::move(
		std::uint64_t id, const AddedInstance &instance, std::uint64_t &r_id, std::vector<InstanceChange> &r_changes) {
	if (const Status status = validate(instance); !status.ok()) {
		return status;
	}
	const bool by_hand = is_added(id);
	if (layer_of(id) != instance.layer || (by_hand ? added(id) == nullptr : removed(id))) {
		return Status::missing("id", "Use the id of an instance, which is never 0");
	}
	const AddedInstance placed = without_signed_zeros(instance);
	const std::uint64_t new_id = by_hand
			? id
			: id_for(placed, [this](std::uint64_t candidate) { return content_->added.contains(candidate); });
	Journal::Noting noting(journal_.get());
	const Status status = guarded("instance", 1.0, [&] {
		noting.record([&] {
			StateStep step = step_of(id, placed);
			step.kind = Kind::move;
			step.to = new_id;
			return step;
		});
		put_for(id, new_id, placed, r_changes);
	});
	noting.keep_if(status.ok());
	r_id = status.ok() ? new_id : r_id;
	return status;
}

/// Places an instance as `new_id`, with the data of `id`. `id` is either `new_id` or the point of the set
/// that the instance replaces.
void InstanceState::put_for(
		std::uint64_t id, std::uint64_t new_id, const AddedInstance &instance, std::vector<InstanceChange> &r_changes) {
	const auto visit_entries = [&](const auto &use) {
		Content::Entry entry = content_->placed_as(new_id, instance);
		if (new_id != id) {
			const Content::Entry previous = content_->entry(id);
			entry.data = previous.data;
			entry.data_at = previous.data_at;
		}
		use(new_id, entry);
		if (new_id != id) {
			use(id, Content::Entry{.removed = true});
		}
	};
	content_->change_all(visit_entries, r_changes);
}

Status InstanceState::set_data(std::uint64_t id, std::span<const std::uint8_t> bytes) {
	if (bytes.size() > max_instance_data) {
		return Status::wrong_size("data", bytes.size(), at_most(max_instance_data, "bytes per instance"));
	}
	Content::Entry target = content_->entry(id);
	if (is_added(id) && target.instance == nullptr) {
		return Status::missing("id", "Use the id of an instance, which is never 0");
	}
	if (!std::ranges::equal(target.data, bytes)) {
		target.data_at = content_->time_of_write(target.data.empty() ? -1.0 : target.data_at);
	}
	target.data = bytes;
	const auto step = [&] {
		return StateStep{.kind = Kind::set_data, .id = id, .data = {bytes.begin(), bytes.end()}};
	};
	const auto size = static_cast<double>(bytes.size());
	return Journal::noting(
			journal_.get(), "data", size, step, [&] { return content_->change_one(id, target, "data", size).status; });
}

Status InstanceState::advance(double seconds, std::vector<InstanceChange> &r_changes) {
	if (!(seconds > 0.0)) {
		return {};
	}
	const double end_time = std::min(content_->time + seconds, max_state_time);
	Journal::Noting noting(journal_.get());
	const Status status = guarded("seconds", seconds, [&] {
		noting.record([&] { return StateStep{.kind = Kind::advance, .number = seconds}; });
		if (StateStep *step = noting.last()) {
			content_->for_each_due(end_time, [step](std::uint64_t id) { step->restored.push_back(id); });
		}
		content_->move_clock(end_time, r_changes);
	});
	noting.keep_if(status.ok());
	return status;
}

Status InstanceState::clear(std::vector<InstanceChange> &r_changes) {
	return guarded("changes", static_cast<double>(content_->size()), [&] { content_->start_from({}, r_changes); });
}

} // namespace thicket
