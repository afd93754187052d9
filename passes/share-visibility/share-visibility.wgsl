// Makes each virtual light as visible as the cluster that it belongs to. [Dong et al. 2009; ACRSM §3.2.5]

#input maps: Visibility // Maps of a few lights.
#input lights: VirtualLights // The lights of the maps.
#input owners: Owners // Which of these each light of a reader belongs to.
#output visibility: Visibility hands on maps // The same maps, for all lights.
