// Makes each virtual light as visible as the cluster that it belongs to. [Dong et al. 2009; ACRSM §3.2.5]

#input maps: Visibility // Maps of a few lights.
#input lights: VirtualLights // The lights of the maps.
#input owners: Owners // The light here to which each light of a reader belongs.
#output visibility: Visibility hands on maps // The same maps, for all lights.
