"""The text of a scene file that is quickly solved."""

SCENE = """
scene:
  length: 1e-4
  body: {youngs_modulus: 70e9, poissons_ratio: 0.33, aspect_ratio: 1/2}
  roughness: {method: psd, hurst: 0.8, rms_gradient: 0.01}
  interface: {hard_wall: {}}
  loading: {reduced_pressure: 0.05}
discretisation: {eps_c: 1/4, eps_f: 1/16, eps_t: 1/2}
"""
