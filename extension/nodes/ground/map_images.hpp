#pragma once

#include <godot_cpp/classes/image.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <cstdint>
#include <map>

namespace thicket {

/// The images of the maps of a node like HTerrain. The node's data contains images in the editor, and for maps that a
/// script created. In a game, all loaded maps except heights are textures, whose pixels must be read back from the
/// renderer. An imported texture never changes, so its pixels are kept for the next time.
class MapImages {
public:
	/// An object for the next time that reuses the images read here.
	MapImages next() const {
		MapImages images;
		images.known_ = kept_;
		return images;
	}

	/// Reads the pixels of a map. `kind` is the plug-in's number for its kind. Null if there is none. Runs scripts.
	godot::Ref<godot::Image> read(const godot::Variant &p_data, int kind, int index);

	/// True if a map had no available pixels, as with the textures of a server's export.
	bool lacks_pixels() const { return lacks_pixels_; }

private:
	godot::Ref<godot::Image> read_texture(const godot::Variant &p_texture);

	using ByTexture = std::map<std::uint64_t, godot::Ref<godot::Image>>; ///< By the texture's ID.
	ByTexture known_;
	ByTexture kept_; ///< The images read here; textures that have been removed are not kept.
	bool lacks_pixels_ = false;
};

} // namespace thicket
