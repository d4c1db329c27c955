// Where everything stands. North is +z, east is +x; the sun comes from the south-west.
#include "layout.h"

#include <vector>

#include "parts.h"
#include "random.h"

namespace plaza {
namespace {

// A row of houses, side by side, from the left end of a wall frame.
void row(Mesh& mesh, const Frame& start, const std::vector<Building>& houses) {
  double x = 0;
  for (const Building& house : houses) {
    building(mesh, moved(start, {x, 0, 0}), house);
    x += house.bays * house.bay;
  }
}

// Frames of the walls: x runs to the right of one who looks at the wall from the square.
Frame wall_frame(const Vec3d& origin, double degrees) {
  return turned(Frame{origin, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, degrees);
}

Building house(int bays, double bay, Surface wall, Surface joinery, Ground ground_floor, int storeys,
               double height, uint32_t seed) {
  Building b;
  b.bays = bays;
  b.bay = bay;
  b.wall = wall;
  b.joinery = joinery;
  b.ground = ground_floor;
  b.storeys = storeys;
  b.height = height;
  b.seed = seed;
  return b;
}

void houses(Mesh& mesh, const Plan& plan) {
  begin_group(mesh, "north");
  Building palace = house(11, 3.6, Surface::plaster_ochre, Surface::paint_white, Ground::arcade, 3, 1.05, 71);
  palace.crown = Crown::balustrade;
  palace.depth = 12;
  // The north row looks south: its left end is in the east.
  row(mesh, wall_frame({plan.east - 9, plan.curb, plan.north}, 180),
      {house(3, 3.2, Surface::plaster_rose, Surface::paint_green, Ground::shops, 4, 1.0, 72), palace,
       house(4, 3.3, Surface::plaster_green, Surface::paint_white, Ground::shops, 4, 1.02, 73)});

  begin_group(mesh, "east");
  // The east row looks west: its left end is in the south.
  row(mesh, wall_frame({plan.east, plan.curb, plan.south}, -90),
      {house(5, 3.2, Surface::plaster_white, Surface::paint_green, Ground::shops, 4, 1.0, 81),
       house(4, 3.3, Surface::plaster_rose, Surface::paint_white, Ground::shops, 4, 1.04, 82),
       house(5, 3.1, Surface::azulejo, Surface::paint_white, Ground::shops, 4, 0.98, 83),
       house(4, 3.4, Surface::plaster_white, Surface::paint_red, Ground::shops, 4, 1.05, 84),
       house(4, 3.2, Surface::plaster_blue, Surface::paint_white, Ground::doors, 3, 1.08, 85)});
}

}  // namespace

void lay_out(Mesh& mesh) {
  const Plan plan;
  ground(mesh, plan);
  houses(mesh, plan);
}

}  // namespace plaza
