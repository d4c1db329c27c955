// The things that stand on the square. Each is built in a frame: its origin on the ground (or at the
// foot of a wall), y up, z toward the beholder, metres.
#pragma once
#include <cstdint>
#include <vector>

#include "geometry.h"

namespace plaza {

// --- windows and walls --------------------------------------------------------------------------

// How much of a facade is worth building: `fine` is seen from the square's cameras, `plain` only in
// reflections.
enum class Finish { plain, fine };

// A rectangular hole in a wall, in the wall's frame.
struct Hole {
  double x0, x1, y0, y1;
};

enum class Filling { casement, shopfront, door, cafe };
struct Joinery {
  Filling filling = Filling::casement;
  Surface paint = Surface::paint_white;
  Finish finish = Finish::fine;
  uint32_t seed = 0;
};
// Closes a hole: reveal, joinery with panes, and a dark room with curtains behind them.
void fill_hole(Mesh& mesh, const Frame& wall, const Hole& hole, const Joinery& joinery);
// A stone surround; `crowned` windows carry a little cornice.
enum class Surround { plain, crowned };
void surround(Mesh& mesh, const Frame& wall, const Hole& hole, Surround kind);
void iron_balcony(Mesh& mesh, const Frame& wall, double x0, double x1, double y, Finish finish);
void railing(Mesh& mesh, const Frame& frame, double x0, double x1, double spacing, double height);
// Stone balusters between a plinth and a handrail, along x from x0 to x1, standing on y = 0.
void balustrade(Mesh& mesh, const Frame& frame, double x0, double x1);
void shop_awning(Mesh& mesh, const Frame& wall, double x0, double x1, double y);

// What is seen behind a window, behind a shop's pane, and behind the panes of a whole ground floor.
inline constexpr double kReveal = 0.24;  // metres from the wall's face to the joinery
inline constexpr double kRoom = 2.2;     // depth of a room
void furnish_room(Mesh& mesh, const Frame& wall, const Hole& hole, uint32_t seed);
void furnish_shop(Mesh& mesh, const Frame& wall, const Hole& hole, uint32_t seed);
void cafe(Mesh& mesh, const Frame& wall, double width, double height, double depth);

struct Storey {
  double height;
  double sill, head, width;  // the hole: from the storey's floor, and its width
  Filling filling = Filling::casement;
  Surround frame = Surround::plain;
  enum class Balcony { none, iron } balcony = Balcony::none;
};

enum class Ground { shops, doors, arcade, cafe };
enum class Crown { tiles, balustrade };

struct Building {
  int bays = 5;
  double bay = 3.3;  // width of one, metres
  double depth = 10;
  Surface wall = Surface::plaster_ochre;
  Surface joinery = Surface::paint_white;
  Ground ground = Ground::shops;
  Crown crown = Crown::tiles;
  double height = 1;  // of the storeys, relative
  int storeys = 4;
  Finish finish = Finish::fine;
  uint32_t seed = 0;
};
// The frame stands at the left foot of the facade. Returns the height of the eaves.
double building(Mesh& mesh, const Frame& frame, const Building& building);
double arcade(Mesh& mesh, const Frame& frame, int bays, double bay, Finish finish);  // returns its height
// A tiled roof over [0, width] x [-depth, 0] with its eaves at y = 0; dormers every second bay.
struct Roof {
  double width, depth, bay;
  Surface wall;
  Finish finish;
  uint32_t seed;
};
void tiled_roof(Mesh& mesh, const Frame& frame, const Roof& roof);

// --- the square ---------------------------------------------------------------------------------

// Where things lie, in the world.
struct Plan {
  double west = -24, east = 48, south = -34, north = 34;  // the walls
  double sidewalk = 4.5, road = 6.0;                      // widths
  double curb = 0.14;                                     // height of sidewalks and island
  Vec3d monument{12, 0, 0};
};
void ground(Mesh& mesh, const Plan& plan);

void monument(Mesh& mesh, const Frame& frame);
void fountain(Mesh& mesh, const Frame& frame);

// A clothed figure; stone ones stand on pedestals, others walk.
struct Figure {
  double height = 1.75;
  Surface cloth = Surface::stone, skin = Surface::stone, hair = Surface::stone;
  double left_arm = 15, right_arm = 15;    // degrees the upper arm leaves the body, sideways
  double left_fore = 10, right_fore = 10;  // degrees the forearm bends forward
  enum class Dress { robe, trousers } dress = Dress::robe;
  double stride = 0;  // degrees between the legs
};
void figure(Mesh& mesh, const Frame& frame, const Figure& figure);

void street_lamp(Mesh& mesh, const Frame& frame);
void bench(Mesh& mesh, const Frame& frame);
void bollard(Mesh& mesh, const Frame& frame);
void flower_stall(Mesh& mesh, const Frame& frame);
void kiosk(Mesh& mesh, const Frame& frame);
void chair(Mesh& mesh, const Frame& frame, Surface paint);
void cafe_table(Mesh& mesh, const Frame& frame, uint32_t seed);
void tram(Mesh& mesh, const Frame& frame);
enum class Species { plane, jacaranda };
void tree(Mesh& mesh, const Frame& frame, Species species, double height, uint32_t seed);
void skyline(Mesh& mesh, const Plan& plan);

}  // namespace plaza
