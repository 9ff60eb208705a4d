#include "core/state/diff_summary.hpp"

#include "core/base/guard.hpp"
#include "core/state/instance_state_content.hpp"
#include "core/state/state_format.hpp"

namespace thicket {

namespace {

void add_area(const Rect &area, DiffSummary::Layer &r_layer) {
	Rect &bounds = r_layer.bounds;
	bounds = r_layer.has_bounds ? united(bounds, area) : area;
	r_layer.has_bounds = true;
}

} // namespace

Status InstanceState::inspect(
		std::span<const std::uint8_t> bytes, DiffSummary &r_summary, const DiffLimits &limits) const {
	r_summary = {};
	StateHeader header;
	if (const Status status = read_header(bytes, header); !status.ok()) {
		return status;
	}
	r_summary.replaces_everything = header.is_complete;
	r_summary.time = header.time;
	r_summary.origin = header.origin;
	r_summary.changes = header.named();
	DiffLimits reading = limits;
	reading.allow_replacement = true;
	StateRecord record;
	if (const Status status = read(bytes, record, reading); !status.ok()) {
		return status;
	}
	r_summary.changes = record.size();
	return guarded("data", static_cast<double>(bytes.size()), [&] {
		std::map<std::uint16_t, DiffSummary::Layer> layers;
		record.for_each([&](std::uint64_t id, const StateRecord::Entry &entry) {
			DiffSummary::Layer &r_layer = layers[layer_of(id)];
			const bool placed = is_added(id);
			++(placed ? (entry.instance != nullptr ? r_layer.added : r_layer.removed_placed)
					  : (entry.removed ? r_layer.removed : r_layer.present));
			r_layer.with_data += entry.data.empty() ? 0 : 1;
			r_layer.data_bytes += entry.data.size();
			const AddedInstance *instance = entry.instance != nullptr ? entry.instance : content_->instance_of(id);
			Rect area;
			if (placed && instance != nullptr) {
				const glm::dvec2 position(instance->position.x, instance->position.z);
				add_area({position, position}, r_layer);
			} else if (!placed && content_->find_cell(id, area)) {
				add_area(area, r_layer);
			} else {
				r_layer.has_all_bounds = r_layer.has_all_bounds && placed;
			}
		});
		r_summary.layers = std::move(layers);
	});
}

} // namespace thicket
