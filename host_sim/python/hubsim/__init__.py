"""The simulated vehicle: scenarios, runs and reports in front of the C engine that holds firmware and plant.

Units are part of every name. Torques are per driven wheel; motor torque is signed, positive driving forward; braking
demands and hydraulic torques are magnitudes. Energies are those of the whole vehicle.
"""

__version__ = "0.1.0"
