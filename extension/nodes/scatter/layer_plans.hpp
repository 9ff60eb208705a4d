#pragma once

#include "core/placement/layer_edits.hpp"
#include "core/placement/layer_links.hpp"
#include "nodes/layer/scatter_layer.hpp"
#include "nodes/scatter/scatter_stream.hpp"
#include "nodes/region/region_register.hpp"

#include <godot_cpp/variant/string.hpp>
#include <godot_cpp/variant/typed_array.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace thicket {

/// What all layers of a node stand on.
struct ScatterGround {
	std::uint64_t seed = 0;
	std::shared_ptr<const Terrain> terrain; ///< Null where the main thread has to ask a script.
	EditedArea changed;                     ///< Where it is not what it was at the last update.
};

/// Turns a node's list of layers into what workers need, and finds out what has to be made anew for it. Main thread
/// only.
class LayerPlans {
public:
	/// Reads the layers as they are now. Returns for each where its tiles are outdated. A layer whose settings are
	/// refused keeps its last good ones, for its neighbors too, and one error is printed.
	std::vector<EditedArea> update(
			const godot::TypedArray<ScatterLayer> &p_layers, const ScatterGround &ground, RegionRegister &regions);

	/// By place, null entries of the node's list included, which are not wanted.
	const std::vector<StreamedLayer> &streamed() const { return streamed_; }

	/// Forgets everything: all of the next update is new.
	void clear();

private:
	struct Place {
		std::optional<NamedLayer> source; ///< In its last good state; none where no layer is.
		godot::String complaint;          ///< The error that was printed last; empty while all is well.
	};

	Status read(std::size_t index, const godot::Ref<ScatterLayer> &p_layer, std::uint64_t seed);
	void complain(std::size_t index, const Status &status);
	std::vector<LinkedLayer> link() const;
	EditedArea replace_plan(std::size_t index, const SharedLayer &settings, const ScatterGround &ground);

	std::vector<Place> places_;
	std::vector<StreamedLayer> streamed_;
	std::vector<StreamedLayer> next_; ///< Working memory of `update`.
	EditSearch search_;               ///< Likewise.
};

/// What a layer says of itself and of others by name; without settings.
NamedLayer names_of(const ScatterLayer &layer);

} // namespace thicket
