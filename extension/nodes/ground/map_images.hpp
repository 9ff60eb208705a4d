#pragma once

#include <godot_cpp/classes/image.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <cstdint>
#include <map>

namespace thicket {

/// The images of the maps of a node like HTerrain. Its data keeps images in the editor, and of what a script made. In a game
/// the maps that were loaded are textures, but for heights: then the pixels are those of the texture, which the renderer has to
/// hand back. So what was read of an imported texture, which never changes, is kept for the next time.
class MapImages {
public:
	/// One for the next time: it knows what this one has read.
	MapImages next() const {
		MapImages images;
		images.known_ = kept_;
		return images;
	}

	/// The pixels of a map, by the plug-in's number of its kind; null where there is none. Runs scripts.
	godot::Ref<godot::Image> read(const godot::Variant &p_data, int kind, int index);

	/// True if there was a map whose pixels nobody had, as with the textures of a server's export.
	bool lacks_pixels() const { return lacks_pixels_; }

private:
	godot::Ref<godot::Image> read_texture(const godot::Variant &p_texture);

	using ByTexture = std::map<std::uint64_t, godot::Ref<godot::Image>>; ///< By the id of the texture.
	ByTexture known_;
	ByTexture kept_; ///< What was read here: of textures that have gone nothing stays.
	bool lacks_pixels_ = false;
};

} // namespace thicket
