"""The texts of a scene file and a surface file that are quickly computed."""

SCENE = """
scene:
  length: 1e-4
  body: {youngs_modulus: 70e9, poissons_ratio: 0.33, aspect_ratio: 1/2}
  roughness: {method: psd, hurst: 0.8, rms_gradient: 0.01}
  interface: {hard_wall: {}}
  loading: {reduced_pressure: 0.05}
discretisation: {eps_c: 1/4, eps_f: 1/16, eps_t: 1/2}
"""
SURFACE = """\
surface:
  method: psd
  model: exponential
  hurst: 0.8
  correlation_length: 4e-6
  mound_separation: 9e-6
  cut_on: 1e-6
  rms_height: 3e-7
  points: 512
length: 1e-4
"""
