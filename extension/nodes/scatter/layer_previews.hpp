#pragma once

#include "nodes/layer/scatter_layer.hpp"

#include <godot_cpp/variant/typed_array.hpp>

#include <cstdint>
#include <map>
#include <set>
#include <vector>

namespace thicket {

/// How the editor's view differs from what layers say: some are not drawn, others are shown with other settings while a designer makes up
/// their mind. It is the editor's alone: never stored, and of no consequence in a game.
class LayerPreviews {
public:
	/// These layers are not drawn; all others are. What stands elsewhere because of them stays as it is.
	void set_hidden(const godot::TypedArray<ScatterLayer> &p_layers);

	/// `p_stand_in` is shown in place of a layer; null for the layer itself.
	void set_stand_in(const godot::Ref<ScatterLayer> &p_layer, const godot::Ref<ScatterLayer> &p_stand_in);

	/// Whether each of these layers is hidden, by index; empty if none is.
	std::vector<bool> hidden(const godot::TypedArray<ScatterLayer> &p_layers) const;

	/// What is shown for a layer: itself, or what stands in for it.
	godot::Ref<ScatterLayer> shown(const godot::Ref<ScatterLayer> &p_layer) const;

private:
	// By the engine's ids: a layer that has gone is kept by nobody.
	std::set<std::uint64_t> hidden_;
	std::map<std::uint64_t, godot::Ref<ScatterLayer>> stand_ins_;
};

} // namespace thicket
