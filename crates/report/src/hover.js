(function(){
var tip=document.createElement("div");tip.id="tip";document.body.appendChild(tip);
function at(field,x,y){
  if(field.points){
    var best=150,text="";
    field.points.forEach(function(p){var d=(p[0]-x)*(p[0]-x)+(p[1]-y)*(p[1]-y);if(best>d){best=d;text=p[2]}});
    return text;
  }
  if(field.left>x||field.upper>y||y>field.bottom)return "";
  var i=field.right.findIndex(function(end){return end>x}),j=field.top.findIndex(function(end){return y>end});
  if(0>i||0>j)return "";
  return field.x[i]+", "+field.y[j]+": "+field.values[j*field.x.length+i];
}
document.querySelectorAll("figure").forEach(function(figure){
  var svg=figure.querySelector("svg"),data=figure.querySelector("script");
  if(!svg||!data)return;
  var fields=JSON.parse(data.textContent),box=svg.viewBox.baseVal;
  svg.addEventListener("pointermove",function(event){
    var area=svg.getBoundingClientRect();
    var x=(event.clientX-area.left)*box.width/area.width/10,y=(event.clientY-area.top)*box.height/area.height/10;
    var text=fields.map(function(field){return at(field,x,y)}).find(function(one){return one})||"";
    tip.textContent=text;tip.style.display=text?"block":"none";
    tip.style.left=Math.min(event.pageX+12,document.documentElement.scrollWidth-260)+"px";tip.style.top=event.pageY+14+"px";
  });
  svg.addEventListener("pointerleave",function(){tip.style.display="none"});
});
})();
