#include "nodes/drawing/fade_viewers.hpp"

#include "nodes/common/engine_arrays.hpp"
#include "nodes/layer/layer_materials.hpp"

#include <godot_cpp/classes/rendering_server.hpp>
#include <godot_cpp/variant/packed_float32_array.hpp>
#include <godot_cpp/variant/string_name.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <map>

using namespace godot;

namespace thicket {

namespace {

constexpr const char *count_name = "scatter_viewer_count";
constexpr const char *viewers_name = "scatter_viewers";

/// The viewers of all nodes, because materials can be shared between nodes.
struct AllViewers {
	struct Entry {
		glm::vec4 position_and_scale{0.0F};
		const FadeViewers *owner = nullptr; ///< The node that set the viewer last.
	};
	std::map<std::uint64_t, Entry> by_id;
	std::uint64_t version = 1; ///< Incremented by every change.

	static AllViewers &get() {
		static AllViewers viewers;
		return viewers;
	}

	void set(const FadeViewer &viewer, const FadeViewers *owner) {
		Entry &entry = by_id[viewer.id];
		version += entry.owner == nullptr || entry.position_and_scale != viewer.position_and_scale ? 1 : 0;
		entry = {viewer.position_and_scale, owner};
	}

	void remove(std::uint64_t id, const FadeViewers *owner) {
		const auto entry = by_id.find(id);
		if (entry != by_id.end() && entry->second.owner == owner) {
			by_id.erase(entry);
			++version;
		}
	}

	std::vector<glm::vec4> nearest(glm::vec3 camera, std::size_t max_count) const {
		std::vector<glm::vec4> positions_and_scales;
		for (const auto &[id, entry] : by_id) {
			positions_and_scales.push_back(entry.position_and_scale);
		}
		if (positions_and_scales.size() > max_count) {
			std::ranges::stable_sort(positions_and_scales, {}, [camera](const glm::vec4 &position_and_scale) {
				return glm::distance(glm::vec3(position_and_scale), camera);
			});
			positions_and_scales.resize(max_count);
		}
		return positions_and_scales;
	}
};

} // namespace

void FadeViewers::set_layers(std::span<const SharedSnapshot> layers) {
	materials_ = materials_with(layers, count_name, Variant::INT);
	written_version_ = 0;
}

void FadeViewers::set_viewers(std::span<const FadeViewer> viewers, glm::vec3 camera) {
	AllViewers &all_viewers = AllViewers::get();
	if (!viewers.empty()) {
		for (const FadeViewer &old_viewer : viewers_) {
			if (std::ranges::find(viewers, old_viewer.id, &FadeViewer::id) == viewers.end()) {
				all_viewers.remove(old_viewer.id, this);
			}
		}
		for (const FadeViewer &viewer : viewers) {
			all_viewers.set(viewer, this);
		}
		viewers_.assign(viewers.begin(), viewers.end());
	}
	if (written_version_ == all_viewers.version) {
		// No viewer has changed since the last write.
		return;
	}
	write(all_viewers.nearest(camera, max_viewers));
	written_version_ = all_viewers.version;
}

void FadeViewers::write(std::span<const glm::vec4> viewers) {
	if (materials_.empty()) {
		// No material fades.
		return;
	}
	PackedFloat32Array positions_and_scales;
	const std::span<float> out = resize(positions_and_scales, static_cast<int64_t>(4 * max_viewers));
	for (std::size_t index = 0; index < viewers.size(); ++index) {
		for (glm::length_t axis = 0; axis < 4; ++axis) {
			out[4 * index + static_cast<std::size_t>(axis)] = viewers[index][axis];
		}
	}
	RenderingServer *server = RenderingServer::get_singleton();
	for (const Ref<Material> &material : materials_) {
		// Set the value on the RenderingServer. A value that is set on the Material would be saved
		// with it.
		server->material_set_param(material->get_rid(), viewers_name, positions_and_scales);
		server->material_set_param(material->get_rid(), count_name, static_cast<int64_t>(viewers.size()));
	}
}

void FadeViewers::clear() {
	for (const FadeViewer &viewer : viewers_) {
		AllViewers::get().remove(viewer.id, this);
	}
	viewers_.clear();
	// Other nodes may share these materials.
	write(AllViewers::get().nearest(glm::vec3(0.0F), max_viewers));
	materials_.clear();
	written_version_ = 0;
}

} // namespace thicket
