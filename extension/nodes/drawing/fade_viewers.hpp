#pragma once

#include "nodes/layer/layer_snapshot.hpp"

#include <godot_cpp/classes/material.hpp>
#include <godot_cpp/classes/ref.hpp>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// A viewer in the format of scatter_fade.gdshaderinc.
struct FadeViewer {
	std::uint64_t id = 0; ///< The viewer's object ID.
	/// The viewer's position in the engine's space (xyz), and Viewer::radius_scale minus 1 (w).
	glm::vec4 position_and_scale{0.0F};
};

/// Passes viewers to those materials of a node's layers that include scatter_fade.gdshaderinc.
/// Those materials measure fade distances from these viewers, regardless of the camera that
/// renders. Nodes may share materials, so each material receives the viewers of all nodes. Use it
/// only on the main thread.
class FadeViewers {
public:
	/// The maximum number of viewers that the shader supports. If there are more, only those
	/// nearest to the camera are passed.
	static constexpr std::size_t max_viewers = 8;

	FadeViewers() = default;
	~FadeViewers() { clear(); }
	FadeViewers(const FadeViewers &) = delete;
	FadeViewers &operator=(const FadeViewers &) = delete;

	void set_layers(std::span<const SharedSnapshot> layers);

	/// Sets the node's viewers for this frame. If `viewers` is empty, the previous viewers stay in
	/// effect, because their tiles stay too. `camera` is the camera's position in the engine's
	/// space.
	void set_viewers(std::span<const FadeViewer> viewers, glm::vec3 camera);

	/// Removes the node's viewers and releases its materials. Without viewers, the materials fade
	/// by the distance to the camera.
	void clear();

private:
	void write(std::span<const glm::vec4> viewers);

	std::vector<godot::Ref<godot::Material>> materials_;
	std::vector<FadeViewer> viewers_;
	/// The version of the list of all nodes' viewers that was last written to the materials; 0
	/// before the first write.
	std::uint64_t written_version_ = 0;
};

} // namespace thicket
