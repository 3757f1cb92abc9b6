"""USD: stages that reach no file outside their folder, and the skeletal animation (UsdSkel) in them."""
