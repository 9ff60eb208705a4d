#pragma once

#include <godot_cpp/classes/image.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <cstdint>
#include <map>

namespace thicket {

/// Reads the images of an HTerrain node's maps. The node's data contains images in the editor and
/// for maps that a script has created. In a game, all other loaded maps except heights are
/// textures, whose pixels must be read back from the renderer. Imported textures never change, so
/// their pixels are kept for the next copy.
class MapImages {
public:
	/// Creates an object for the next copy that reuses the images read here.
	MapImages for_next_copy() const {
		MapImages images;
		images.previous_ = imported_;
		return images;
	}

	/// Reads the pixels of a map. `kind` is the plugin's ID of the kind of map. Returns null if
	/// there are none. Runs scripts.
	godot::Ref<godot::Image> read(const godot::Variant &p_data, int kind, int index);

	/// Returns true if the pixels of a map were not available, as for textures in a dedicated
	/// server export.
	bool lacks_pixels() const { return lacks_pixels_; }

private:
	godot::Ref<godot::Image> read_texture(const godot::Variant &p_texture);

	/// Images, keyed by texture ID.
	using ByTexture = std::map<std::uint64_t, godot::Ref<godot::Image>>;
	ByTexture previous_; ///< The imported images of the previous copy.
	ByTexture imported_; ///< The imported images that were read here.
	bool lacks_pixels_ = false;
};

} // namespace thicket
