#pragma once

#include "core/placement/layer.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace thicket {

/// A reference to a layer by name, by index in the list, or by identity. At most one of the three
/// is set.
struct LayerReference {
	std::string name;           ///< If several layers have this name, it means the first.
	std::int64_t index = -1;    ///< Index in the list; negative if not set.
	std::uint64_t identity = 0; ///< LayerLinks::identity of a layer that may have no name.

	LayerReference() = default;
	LayerReference(std::string name) : name(std::move(name)) {}
	LayerReference(const char *name) : name(name) {}

	/// Returns true if the reference refers to no layer.
	bool empty() const { return name.empty() && index < 0 && identity == 0; }

	friend auto operator<=>(const LayerReference &, const LayerReference &) = default;
};

/// A layer's name and identity, and its references to other layers.
struct LayerLinks {
	std::string name;           ///< Empty if the layer has no name.
	std::uint64_t identity = 0; ///< A number unique to this layer; 0 if it has none.

	/// Minimum distances in meters from other layers; 0 for no spacing. If both layers of a pair
	/// set a distance, the larger one applies. The layer that comes later in the list gives way.
	std::map<LayerReference, double> spacing;
	bool spacing_fills = false; ///< See LayerSettings::spacing_fills. Without spacing, it has no effect.
	bool on_surface = false;    ///< PointSet::on_surface of the layer.

	/// The layer near whose instances this one is placed; empty if there is none. It must be
	/// earlier in the list to have an effect.
	LayerReference proximity_layer;
	double proximity_distance = 0.0;                   ///< Distance to proximity_layer in meters; 0 if unused.
	std::shared_ptr<const CurveTable> proximity_curve; ///< See Neighbor::curve; null disables proximity.

	/// The layers whose distance determines colors and variations; empty if there are none. They
	/// must be earlier in the list to have an effect.
	LayerReference color_layer;
	LayerReference variation_layer;
	LayerReference scale_layer;

	/// The names of the layers to which expressions measure distances. They must be earlier in the list
	/// to have an effect.
	std::set<std::string> measured_layers;

	/// The layers on whose models this layer grows, if it is on surfaces. Entries have an effect
	/// only if they refer to layers earlier in the list. If the list is empty, the layer grows on
	/// the ground.
	std::vector<LayerReference> surface_layers;

	friend bool operator==(const LayerLinks &, const LayerLinks &) = default;
};

/// A layer before its references are resolved. All pointers are null if there is no layer at an
/// index.
struct UnlinkedLayer {
	const LayerSettings *settings = nullptr; ///< Settings without neighbors and source layers.
	const LayerLinks *links = nullptr;
	/// The layer's models, and the game's changes to its instances. Null if there are none. If the
	/// models are null, no layer can grow on this layer.
	std::shared_ptr<const HostModels> models = nullptr;
	std::shared_ptr<const HostChanges> changes = nullptr;
};

using SharedLayer = std::shared_ptr<const LayerSettings>;

/// A layer after its references are resolved.
struct LinkedLayer {
	/// Settings with neighbors and source layers; null if there is no layer at this index.
	SharedLayer settings;
	Status status; ///< The error of new settings that were rejected. The layer then keeps its previous ones.
};

/// An additional check that may reject a layer. It receives the settings with neighbors, and the
/// index in the list.
using LayerCheck = std::function<Status(const LayerSettings &layer, std::size_t index)>;

/// Returns the indices of all layers to which LayerLinks::surface_layers refers in any layer. The
/// pointers in `layers` may be null.
std::set<std::size_t> hosts_in(std::span<const LayerLinks *const> layers);

/// Resolves references into pointers. The neighbors of a layer are the earlier layers that it
/// refers to or that refer to it. Its source layers and hosts must be earlier, too. References to
/// missing layers are ignored. `before` contains the settings from the last call, by index; if a
/// layer is unchanged, the same pointer is returned. A layer that fails `validate` or `check` keeps
/// its previous settings.
std::vector<LinkedLayer> link_layers(
		std::span<const UnlinkedLayer> layers, std::span<const SharedLayer> before, const LayerCheck &check = {});

/// Returns a name that is not in `taken_names`: `name` itself, or `name` with the lowest free number from
/// 2 on, as in "Oak 2".
std::string free_layer_name(std::string_view name, std::span<const std::string> taken_names);

/// Describes likely mistakes in a layer's name and references, one string for each. The mistakes are
/// references to unknown layers, spacing from the layer itself, and a name that an earlier layer
/// has. They also include proximity or source layers that are not earlier in the list, and a layer
/// that cannot fill gaps. `layers[index]` must not be null; other entries may be.
std::vector<std::string> name_problems(std::span<const LayerLinks *const> layers, std::size_t index);

} // namespace thicket
